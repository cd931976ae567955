"""Names are text, nowhere markup: in terminal, figures, pages, models, spreadsheets and on disk."""

import json
import os
import re
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest

from bench.assets import asset
from bench.course.recordings import LabRecordings
from bench.course.report import Cover, lab_document
from bench.course.result import TaskResult
from bench.errors import InputError
from bench.files import write_text
from bench.fit.identify import identify
from bench.names import cell, readable, short
from bench.plant.model_file import StoredModel, load_model, model_toml
from bench.plant.plant import Plant
from bench.report.document import Intervals, Picture, Span
from bench.report.figures import drawn, save
from bench.report.html import html
from bench.report.identification import Moved, identification
from bench.report.terminal import show
from bench.rig.rig import Rig, load_rig
from bench.trace.motion import condition, motion
from bench.trace.read import read
from bench.trace.stream import stream
from bench.trace.trace import Trace
from bench.trace.write import write
from tests.command import bench
from tests.hostile import RIG, TABLE, assert_one_line, columns, run

NAMES = [
    "axis [/b]",
    "[link=http://x]y[/link]",
    "[red]x",
    ":smile: axis",
    "a$x^$b",
    "$",
    r"\frac{",
    "<script>alert(1)</script>",
    "=1+1",
    "a\rb\x01c\x1b]0;title\x07\x1b[31m",
    "\u202etxt.exe",
    "half \udcff",
    "two\nlines\t::error::x",
    "軸 🙂",
    "\"]]>'",
]


@pytest.fixture(scope="module")
def identified():
    trace = Trace.from_arrays(dict(zip(("time [s]", "velocity [rad/s]", "current [A]"), columns(), strict=True)))
    rig = Rig.of({"name": "x", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A"}})
    effort, _ = rig.net_effort(trace)
    return rig, identify(trace, rig), motion(trace, effort, effort, condition(trace, effort, None))


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_names_are_text_in_terminal_and_figures(identified, tmp_path, capsys, name):
    rig, estimate, moved = identified
    along = Moved(readable(name), rig.axis_kind, moved, estimate)
    document = identification(readable(name), rig.axis_kind, estimate, motions=[along])
    show(document)
    shown = capsys.readouterr().out
    for character in "\x1b\x07\x01\r\u202e":
        assert character not in shown
    for word in re.findall(r"[\[\]$:<>=/a-z]+", name.split("\x1b")[0]):
        assert word in shown
    assert readable(name) in document.pictures[0].title
    span = Span(name=readable(name), colour="ink", value=2.0, low=1.0, high=3.0)
    texts = dict.fromkeys(("title", "alternative", "label"), readable(name))
    named = Intervals(**texts, right=(0.5, 1.5), limits=(0.5, 5.0), spans=(span,))
    figure = drawn(Picture(name="x", title=readable(name), rows=((named,),)))
    for ending in ("svg", "pdf"):
        save(figure, tmp_path / f"x.{ending}")


@pytest.mark.parametrize("name", [name for name in NAMES if "\udcff" not in name], ids=ascii)
def test_names_are_text_in_a_model_and_come_back(tmp_path, name):
    stored = StoredModel(name, Plant.from_rig(load_rig(asset("data", "rigs", "sh30701p.toml"))).model)
    write_text(tmp_path / "model.toml", model_toml(stored))
    assert load_model(tmp_path / "model.toml").name == name


def test_file_names_that_are_not_utf_8(tmp_path):
    path = os.fsdecode(os.fsencode(tmp_path) + b"/half \xff.csv")
    Path(path).write_text(TABLE)
    assert read(path).origin == f"{tmp_path}/half \\xff.csv"
    write(read(path), Path(path).with_suffix(".parquet"))
    assert next(stream(Path(path).with_suffix(".parquet"))).origin == f"{tmp_path}/half \\xff.parquet"
    done = run("inspect", path, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "") and "half \\xff.csv" in done.stdout
    (tmp_path / "rig.toml").write_text(RIG)
    done = run("identify", path, "--rig", "rig.toml", "--out", "found", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads((tmp_path / "found" / "identify.json").read_text(encoding="utf-8"))
    assert found["provenance"]["traces"][0]["file"] == f"{tmp_path}/half \\xff.csv"
    assert "half \\xff.csv" in (tmp_path / "found" / "report.html").read_text(encoding="utf-8")


def test_names_are_no_formulas_in_a_spreadsheet():
    for text in ("=1+1", "+cmd|x", "-cmd", "@SUM(1)", "\t=1", "-1+1"):
        assert cell(text) == f"'{text}"
    for text in ("a=1", "-1.5e-3", "+2", "-0,5", ""):
        assert cell(text) == text


def test_names_are_text_in_html():
    results = [TaskResult((f"axis: {name}",), key=f"t{place}", title=name) for place, name in enumerate(NAMES)]
    cover = Cover(NAMES[0], tuple((name, name) for name in NAMES))
    page = html(lab_document(results, LabRecordings.in_folder(None), cover))
    assert "<script>" not in page and "&lt;script&gt;" in page


@pytest.mark.parametrize("name", ["axis [/b]", "a$x^$b\r\x01\x1b[31m"])
def test_a_run_with_such_names_ends_well(tmp_path, monkeypatch, name):
    """Rig and recording both have it; before, the traceback came after all the work."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.toml").write_text(RIG.replace('"axis"', json.dumps(name)))
    file = name.replace("/", "")
    (tmp_path / f"{file}.csv").write_text(TABLE)
    done = bench("identify", f"{file}.csv", "--rig", "rig.toml", "--out", "found", "--json", "-")
    assert (done.status, done.err) == (0, "")
    assert "\x1b" not in bench("inspect", f"{file}.csv").out
    assert_one_line(bench("identify", f"{file}.none", "--rig", "rig.toml"), "no such file")


def test_a_text_is_cut_between_words():
    text = " ".join(f"word{k}" for k in range(100))
    for most in range(40, 120):
        cut = short(text, most)
        assert (len(cut) <= most, cut[:6], cut[-7:]) == (True, "word0 ", " word99")
        assert set(cut.split()) <= {*text.split(), "..."}
    assert len(short("x" * 300, 80)) == 79


BROKEN = "now\n::error::evil ##[error]x\t\x1b]0;y\x07.csv"
ON_ONE_LINE = r"now\n::error::evil ## [error]x\t\x1b]0;y\x07.csv"


def test_a_file_name_of_two_lines_is_one_line_wherever_it_is_printed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    (tmp_path / BROKEN).write_text(TABLE)
    (tmp_path / "rig.toml").write_text(RIG)
    base = ("--rig", "rig.toml", "--baseline", f"{BROKEN}.toml")
    done = bench("check", BROKEN, *base, "--update", "--without-names")
    assert (done.status, done.out.splitlines()) == (0, [f"wrote {ON_ONE_LINE}.toml"])
    for form in ("github", "gitlab", "text"):
        done = bench("check", BROKEN, *base, "--format", form, "--junit", f"{form}.xml", "--json", f"{form}.json")
        assert done.status == 0, done.err
        said = done.out + done.err
        assert not any(line.startswith(("::error", "::warning")) for line in said.splitlines())
        assert "##[" not in said and "\x1b" not in said
        (suite,) = ElementTree.parse(tmp_path / f"{form}.xml").getroot()
        assert suite.get("name") == f"{ON_ONE_LINE} against {ON_ONE_LINE}.toml"
    done = bench("identify", BROKEN, "--draft", "drafted.toml", "--out", "found")
    assert done.status == 0
    assert all(line.startswith("warning: ") for line in done.err.splitlines())
    assert tomllib.loads((tmp_path / "drafted.toml").read_text())["kind"] == "rotary"
    assert_one_line(bench("identify", f"{BROKEN}.none", "--rig", "rig.toml"), f"{ON_ONE_LINE}.none: no such file")


def test_an_error_is_one_line_in_python_too():
    with pytest.raises(InputError) as error:
        read("two\nlines.csv")
    assert str(error.value) == r"two\nlines.csv: no such file; give the path of a trace"
