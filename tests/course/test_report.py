"""The report and the commands `lab` and `limits`, as a user meets them."""

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from matplotlib.image import imread

from bench.assets import asset
from bench.course import pdf
from bench.course.recordings import LabRecordings
from bench.course.report import DECLARATION, Cover, course_table, lab_document, task_section, write_lab_report
from bench.course.result import Number, TaskResult
from bench.errors import InputError
from bench.report.document import Picture
from bench.report.figures import drawn
from bench.report.html import html
from bench.report.terminal import in_full, rendered
from tests import command

#: Labels of axes that the course asks for.
LABELS = """y / m; z / m; time / s; t_sync / s; current Iq / A; torque constant kT / (N·m/A); torque M / (N·m)
speed n / rpm; speed ω / (rad/s); acceleration α / (rad/s²); filtered α_filt / (rad/s²); tracking deviation / deg"""


def document(results, cover=None, synthetic=True):
    """The report of results on the synthetic recordings, or on the same as if they were a student's own."""
    recordings = replace(LabRecordings.in_folder(None), synthetic=synthetic)
    return lab_document(results, recordings, cover or Cover())


def test_report_has_every_task_number_and_figure(lab, done):
    text = (lab.folder / "here" / "lab.html").read_text(encoding="utf-8")
    assert re.findall(r'<section id="task-([^"]+)"', text) == list(done)
    assert text.count('<figure class="chart"') == sum(len(task.charts) for task in done.values()) == 12
    assert not [label for label in re.split("; |\n", LABELS) if label not in text]
    for task in done.values():
        assert all(number.unit for number in task.numbers)
        assert all(f'<th scope="row">{number.name}</th>' in text.replace("&#39;", "'") for number in task.numbers)
        assert all(number.source for number in task.numbers)
    assert not re.search(r'(?:src|href)="(?!#)', text), "the page must need no other file"
    for number in range(1, 13):
        assert f"Figure {number}: " in text
    content = (lab.folder / "here" / "lab.pdf").read_bytes()
    assert b"/Type3" not in content
    assert b"/FontFile" in content
    assert len(text.encode()) < 1_000_000
    assert content.startswith(b"%PDF")
    assert len(re.findall(rb"/Type */Page\b", content)) <= 10


def test_what_was_not_done_says_what_is_missing(done):
    missing = TaskResult(
        key="9", title="Least squares", reason=InputError("folder/<b>.trace", "no such file", "found: nothing")
    )
    page = html(document([done["2"], missing]))
    assert "Not done: folder/&lt;b&gt;.trace: no such file; found: nothing" in page
    assert "no such file" in course_table([done["2"], missing]).rows[-1][1]


def test_it_runs_alone_on_one_screen_and_ends_naming_the_report(lab, done, tmp_path):
    assert lab.report.usable
    assert "K_fric_w" in lab.printed
    shown = lab.printed.splitlines()
    assert (shown[-2:], len(shown) <= 42) == (["wrote here/lab.html", "wrote here/lab.pdf"], True)
    assert {path.name for path in (lab.folder / "here").iterdir()} == {"sources", "lab.json", "lab.html", "lab.pdf"}
    shares = []
    files = write_lab_report(tmp_path, document([done["2"]]), "{}\n", shares.append)
    assert (shares, shares[-1]) == (sorted(shares), 1.0)
    assert [path.name for path in files] == ["lab.json", "lab.html", "lab.pdf"]


CURVE = 'mains_voltage = "230 V"\ncorner_speed = "100 rad/s"\nno_load_speed = "300 rad/s"'


@pytest.mark.parametrize(
    ("motor", "out", "status", "words"),
    [
        (None, "range.png", 0, "At 230 V, 400 V, 230 V cold, 400 V cold: least reserve to the peak torque"),
        (None, "range.docx", 2, ".png"),
        ("", "range.png", 0, "Largest torque?"),
        (f"[[motor.peak_curves]]\n{CURVE}\n", "range.png", 2, "peak_torque"),
    ],
)
def test_limits_state_the_reserve_or_what_the_datasheet_lacks(monkeypatch, tmp_path, motor, out, status, words):
    """Without a datasheet they are what the recording runs into."""
    monkeypatch.chdir(tmp_path)
    text = f'name = "a"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\n{motor}'
    lab = asset("data", "rigs", "lab.toml").read_text(encoding="utf-8")
    (tmp_path / "rig.toml").write_text(lab if motor is None else text)
    trace = asset("data", "traces", "JLoadAndFriction.trace")
    done = command.bench("limits", trace, "--rig", "rig.toml", "--out", out)
    assert (done.status, words in " ".join((done.out + done.err).split())) == (status, True), done.err
    assert status == 0 or done.err.count("\n") == 1
    if motor is None and status == 0:
        assert (tmp_path / out).read_bytes()[:4] == b"\x89PNG"


def test_results_stand_as_json_beside_the_report(lab, done):
    content = json.loads((lab.folder / "here" / "lab.json").read_text(encoding="utf-8"))
    assert content["schema"] == "bench.lab/1"
    assert [(task["key"], task["status"]) for task in content["tasks"]] == [(key, "done") for key in done]
    for task in content["tasks"]:
        for number in task["numbers"]:
            printed = done[task["key"]][number["name"]]
            assert (number["value"], number["unit"], number["truth"]) == (printed.value, printed.unit, printed.truth)
            assert number["source"] == printed.source != ""


#: Runs every script in a namespace of its own, which saves starting numpy and matplotlib for each.
EACH = """
import runpy, sys
sys.path.insert(0, "")
for number in range(1, 12):
    print(f"# {number}")
    runpy.run_path(f"task{number:02}.py", run_name="__main__")
"""


@pytest.fixture(scope="module")
def scripts(lab):
    """What each script prints, by the number of its task; all but numpy and matplotlib is in their folder."""
    folder = lab.folder / "here" / "sources"
    ran = subprocess.run([sys.executable, "-c", EACH], cwd=folder, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    parts = re.split(r"^# (\d+)\n", ran.stdout, flags=re.MULTILINE)[1:]
    return dict(zip(map(int, parts[::2]), parts[1::2], strict=True))


@pytest.mark.parametrize("number", range(1, 12))
def test_a_script_that_is_handed_in_gives_the_reports_numbers(lab, done, scripts, number):
    """It uses numpy and matplotlib alone, and draws the task's figure."""
    folder = lab.folder / "here" / "sources"
    for name in (f"task{number:02}", "course", "methods"):
        imported = re.findall(r"^(?:from|import) (\w+)", (folder / f"{name}.py").read_text("utf-8"), re.MULTILINE)
        assert {*imported} <= {"__future__", "course", "json", "matplotlib", "methods", "numpy", "pathlib"}
    found = [re.fullmatch(r"(.+) = (\S+) (\S+)", line) for line in scripts[number].splitlines()]
    assert found
    task = done[str(number)]
    for match in found:
        name, value = match[1], float(match[2])
        # task 11 integrates by itself, and has its corners to the digit that the report prints
        if number == 11:
            assert value == pytest.approx(task[name].value, abs=0.05), name
        else:
            assert value == pytest.approx(task[name].value, rel=1e-6, abs=1e-9), name
    assert (folder / f"task{number:02}.png").exists() == bool(task.charts)


#: The course's own names, the tasks whose numbers each prints, and the figures that it draws.
MATLAB = {
    "catapult": ("1", ["task01"]),
    "derivative_of_sine": ("2", ["task02"]),
    "torque_constants": ("34", ["task04"]),
    "JLoad_no_Friction": ("56", ["task05", "task06"]),
    "JLoad_with_Friction": ("789", ["task07", "task08", "task09"]),
    "SpeedTorqueLimit": (("10",), ["task10"]),
}


@pytest.fixture
def unzipped(lab, tmp_path):
    """The MATLAB sources alone, as a student gets them."""
    with zipfile.ZipFile(lab.folder / "here" / "sources" / "matlab.zip") as archive:
        archive.extractall(tmp_path)
    return tmp_path


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("octave-cli") is None, reason="needs Octave: Debian's package and what it recommends")
@pytest.mark.parametrize("name", MATLAB)
def test_a_matlab_source_gives_the_reports_numbers_and_figures(unzipped, done, name):
    # without a display Octave would draw figures as letters between the numbers
    environment = {**os.environ, "GNUTERM": "unknown"}
    call = ["octave-cli", "-q", f"{name}.m"]
    ran = subprocess.run(call, cwd=unzipped, env=environment, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    found = {line.rsplit(" = ", 1)[0]: float(line.rsplit(" = ", 1)[1].split()[0]) for line in ran.stdout.splitlines()}
    known = {n.name: n.value for key in MATLAB[name][0] for n in (*done[key].numbers, *done[key].tabled)}
    assert found
    for quantity, value in found.items():
        assert value == pytest.approx(known[quantity], rel=1e-7, abs=1e-9), quantity
    assert sorted(path.stem for path in unzipped.glob("*.png")) == MATLAB[name][1]


def test_the_zip_of_the_matlab_sources_needs_no_other_file(unzipped):
    """Every function that is called and every file that is read is in it, and figures need no desktop."""
    sources = {path.stem: path.read_text(encoding="utf-8") for path in unzipped.glob("*.m")}
    assert {*MATLAB, "load_traces", "num_derivative", "torqueconstant"} <= set(sources)
    own = re.compile(r"\b(load_traces|data_file|course_values|keep_figure|four_graphs|filtered|show|num_derivative)\(")
    for name, text in sources.items():
        assert set(own.findall(text)) <= set(sources)
        assert "usejava" not in text
        for trace in re.findall(r"load_traces\('(\w+)'\)", text):
            assert (unzipped / "recordings" / f"{trace}.csv").exists()
        assert re.findall(r"keep_figure\('(\w+)'\)", text) == MATLAB.get(name, ("", []))[1]
    assert (unzipped / "values.json").exists()
    assert (unzipped / "recordings" / "flights.csv").exists()
    assert "subplot(4, 1, k)" in sources["four_graphs"]
    assert sources["JLoad_with_Friction"].count("four_graphs(") == 2
    assert "hold on" in sources["four_graphs"]


def test_a_cover_sheet_names_the_group(tmp_path):
    assert Cover.in_folder(tmp_path) == Cover()
    assert [len(block.rows) for block in Cover().sheet(synthetic=False).blocks[:1]] == [3]
    path = tmp_path / "group.toml"
    path.write_text('group = "7"\n[[student]]\nname = "Ada <L>"\nnumber = "12345"\n')
    cover = Cover.in_folder(tmp_path)
    page = html(document([], cover, synthetic=False))
    assert "Ada &lt;L&gt;" in page
    assert DECLARATION in page
    assert "ourselves" not in html(document([], cover))
    assert "12345" in page
    (sheet, _) = pdf.typeset(document([], cover, synthetic=False), tmp_path)["front"]
    assert sheet["blocks"][0]["rows"] == [["Ada <L>", "12345", "_" * 24]]
    assert sheet["blocks"][0]["caption"] == "Group: 7"
    for text, word in (("group = 7 =", "TOML"), ('[[student]]\nname = "A"\n', "number"), ("team = 1\n", "team")):
        path.write_text(text)
        with pytest.raises(InputError, match=word):
            Cover.in_folder(tmp_path)


@pytest.fixture(scope="module")
def typeset(lab, tmp_path_factory):
    """The report as the template takes it, and the folder with its diagrams."""
    folder = tmp_path_factory.mktemp("typeset")
    return pdf.typeset(document(lab.report.results), folder), folder


def test_pages_of_the_pdf_hold_what_is_said_and_are_full(typeset):
    """No table or diagram leaves a page's margins, and no page but the last leaves half of its height empty."""
    pages = pdf.compiled(*typeset, format="png", ppi=36.0)
    inked = [imread(BytesIO(page))[..., :3].min(axis=2) < 0.9 for page in pages]
    height, width = inked[0].shape
    bottom, side = round(height * 0.94), round(width * 18.0 / 210.0)  # above the page's number, 20 mm less two
    filled = [np.flatnonzero(page[:bottom].any(axis=1))[-1] / bottom for page in inked]
    print("pages filled:", *(f"{share:.0%}" for share in filled))
    assert len(pages) <= 10
    assert all(share > 0.5 for share in filled[:-1])
    assert not any(page[:, :side].any() or page[:, -side:].any() for page in inked)


def test_the_pdf_has_every_cell_number_and_caption(typeset, done):
    content, folder = typeset
    assert [section["heading"] for section in content["front"]] == ["Cover sheet", "Answers"]
    parts = [part for section in content["sections"] for part in section["blocks"]]
    by_kind = {kind: [part for part in parts if part["kind"] == kind] for kind in ("chart", "table", "equation")}
    assert [part["number"] for part in by_kind["equation"] if part["number"]] == ["(16)", "(28)"]
    assert [part["title"].split(":")[0] for part in by_kind["chart"]] == [f"Figure {k}" for k in range(1, 13)]
    tables = len(by_kind["table"])
    assert [part["caption"].split(":")[0] for part in by_kind["table"]] == [f"Table {k}" for k in range(2, tables + 2)]
    assert all((folder / part["file"]).read_bytes().startswith(b"<?xml") for part in by_kind["chart"])
    names = {row[0] for part in by_kind["table"] for row in part["rows"]}
    assert {number.name for task in done.values() for number in task.numbers} <= names
    (answers,) = content["front"][1]["blocks"]
    assert [row[0] for row in answers["rows"]] == [str(k) for k in range(1, 12)]
    for key, words, numbers in answers["rows"]:
        assert words == pdf.plain(done[key].findings[0])
        first = re.search(r"= \(?(−?[\d.]+)([^;]*·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?", numbers)
        assert first
        power = (first[3] or "0").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
        shown = float(f"{first[1]}e{power}".replace("−", "-"))
        assert shown == pytest.approx(done[key].numbers[0].value, rel=5e-3)
    said = " ".join(str(part) for section in content["sections"] for part in section["blocks"])
    assert not re.search(r"(?i)\bbench|estimator|gearbox", said)


def test_text_of_a_report_is_no_markup(tmp_path):
    """What a name holds is shown, whatever Typst would make of it."""
    odd = TaskResult(
        ("#panic() $x$ *b* @ref [a] \\",), (Number('#read("/etc/passwd")', 1.0, "_m_"),), key="8", title="$"
    )
    pdf.write_pdf(tmp_path / "odd.pdf", document([odd]))
    assert (tmp_path / "odd.pdf").read_bytes().startswith(b"%PDF")


def test_11_is_one_statement_three_numbers_and_one_figure(done):
    """What moves the corner is stated once, with one number, which is the difference of the two corners."""
    task = done["11"]
    (sentence,) = task.findings
    hot, cold, inductive = (number.value for number in task.numbers)
    assert re.findall(r"([+-]\d+) rpm", sentence)[0] == f"{cold - hot:+.0f}"
    assert abs(inductive - cold) < 1.0
    assert len(task.charts) == 1


def test_a_legend_covers_no_data(done):
    """Every legend lies above its axes, in the drawn figure."""
    charts = [chart for task in done.values() for chart in task.charts]
    for chart in charts:
        figure = drawn(Picture(name="chart", title="", rows=((chart,),)))
        figure.draw_without_rendering()
        for axes in figure.axes:
            if (legend := axes.get_legend()) is not None:
                assert legend.get_window_extent().y0 >= axes.get_window_extent().y1 - 1.0, chart.title


def test_the_advice_keeps_its_brackets_on_the_terminal():
    reason = InputError("a.csv", "contains no velocity", 'write [trace.columns] velocity = "column [unit]"')
    shown = rendered(course_table([TaskResult(key="6", title="Inertia", reason=reason)]), 80)
    assert '[trace.columns]velocity="column[unit]"' in "".join(shown.plain.split())


@pytest.mark.parametrize("width", [60, 80, 120])
def test_no_number_of_a_task_is_cut_on_a_terminal(done, width):
    table = course_table([*done.values()])
    with in_full():
        shown = rendered(table, width).plain
    assert max(map(len, shown.splitlines())) <= width
    words = {word for row in table.rows for cell in row for word in cell.split(" ") if word}
    assert words <= set(re.split(r"[ \n]+", shown))


@pytest.mark.parametrize("truth", [1.01, None])
def test_the_truth_has_a_column_where_any_number_has_one(truth):
    numbers = Number("J", 1.0, "kg·cm²", truth=truth), Number("E", 2.0, "N²·m²")
    blocks = task_section(TaskResult((), numbers, key="9", title="x")).blocks
    headings = [column.heading for block in blocks for column in block.columns]
    assert ("truth" in headings) is (truth is not None)
