"""The report and the commands `lab` and `limits`, as a user meets them."""

import re
import sys

import pytest

from bench.assets import asset
from bench.cli import main
from bench.errors import InputError
from bench.lab.result import NotDone
from bench.report.course import course_table
from bench.report.lab import lab_html, write_lab_report

#: Labels of axes that the course asks for.
LABELS = (
    "y / m",
    "z / m",
    "torque constant kT / (N·m/A)",
    "current Iq / A",
    "speed ω / (rad/s)",
    "acceleration α / (rad/s²)",
    "torque M / (N·m)",
    "t_sync / s",
    "time / s",
    "speed n / rpm",
    "tracking deviation / deg",
)


@pytest.fixture
def bench(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["bench", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main()
        printed = capsys.readouterr()
        return stop.value.code, printed.out, printed.err

    return run


def test_report_has_every_task_number_and_figure(lab, done):
    text = (lab.folder / "here" / "lab.html").read_text(encoding="utf-8")
    assert re.findall(r'<section id="task-([^"]+)"', text) == list(done)
    assert text.count("<svg") == sum(len(task.charts) for task in done.values()) == 15
    for label in LABELS:
        assert label in text, label
    for task in done.values():
        assert all(number.unit for number in task.numbers)
        assert all(f"<td>{number.name}</td>" in text.replace("&#39;", "'") for number in task.numbers)
        assert all(number.source for number in task.numbers)
    assert not re.search(r'(?:src|href)="(?!#)', text), "the page must need no other file"
    content = (lab.folder / "here" / "lab.pdf").read_bytes()
    assert content.startswith(b"%PDF")
    assert len(re.findall(rb"/Type /Page\b", content)) >= 10


def test_what_was_not_done_says_what_is_missing(done):
    missing = NotDone("9", "Least squares", InputError("folder/<b>.trace", "no such file", "found: nothing"))
    html = lab_html([done["2"], missing], [])
    assert "Not done: folder/&lt;b&gt;.trace: no such file; found: nothing" in html
    assert any("no such file" in str(cell) for cell in course_table([done["2"], missing]).columns[1].cells)


def test_lab_runs_alone_and_ends_naming_the_report(lab):
    assert lab.status == 0
    assert "K_fric_w" in lab.printed
    assert lab.printed.splitlines()[-2:] == ["wrote here/lab.html", "wrote here/lab.pdf"]
    assert {path.name for path in (lab.folder / "here").iterdir()} == {"lab.json", "lab.html", "lab.pdf"}


def test_progress_of_the_report_ends_at_one(done, tmp_path):
    shares = []
    files = write_lab_report(tmp_path, [done["2"]], ["about"], shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert [path.name for path in files] == ["lab.json", "lab.html", "lab.pdf"]


def test_lab_refuses_what_it_cannot_read_in_one_line(bench, tmp_path):
    status, out, err = bench("lab", "--data", "nowhere")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert "nowhere" in err
    assert list(tmp_path.iterdir()) == []


def test_limits_draws_and_states_the_reserve(bench, tmp_path):
    trace, rig = asset("data", "traces", "JLoadAndFriction.trace"), asset("data", "rigs", "lab.toml")
    status, out, _ = bench("limits", trace, "--rig", rig, "--out", "range.png")
    assert status == 0
    assert "At 230 V: least reserve to the peak torque" in out
    assert "At 400 V" in out
    assert (tmp_path / "range.png").read_bytes()[:4] == b"\x89PNG"
    status, out, err = bench("limits", trace, "--rig", rig, "--out", "range.docx")
    assert (status, err.count("\n")) == (2, 1)
    assert ".png" in err


def test_limits_names_what_the_rig_lacks(bench, tmp_path):
    trace = asset("data", "traces", "JLoadAndFriction.trace")
    (tmp_path / "rig.toml").write_text('name = "a"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\n')
    status, _, err = bench("limits", trace, "--rig", "rig.toml")
    assert (status, err.count("\n")) == (2, 1)
    assert "peak_torque" in err
