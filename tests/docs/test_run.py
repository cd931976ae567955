"""Commands of the pages run as they stand, in a folder as a page supposes it; a page has a row in the table."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from bench.assets import asset
from bench.effects.present import parse_effect
from bench.plant.simulate import simulate
from bench.report.publish import read_document
from bench.rig.rig import load_rig
from bench.trace.write import write
from tests.baseline.test_command import again
from tests.diagnosis.command import RIG as OWN_RIG
from tests.docs.pages import PAGES, bench_commands, run_commands, run_examples
from tests.export.two_links import MJCF, log, write_log

RIG = asset("data", "rigs", "sh30701p.toml")
RECORDINGS = ("recording.csv", "monday.csv", "tuesday.csv", "wednesday.csv", "run1.csv", "run2.csv")
DAYS = ("monday", "tuesday", "wednesday", "thursday", "friday", "saturday")


@pytest.fixture(scope="module")
def supposed(tmp_path_factory):
    """A rig that can be simulated, recordings of it that hide a cogging torque, a robot and its log."""
    folder = tmp_path_factory.mktemp("supposed")
    rig, hidden = load_rig(RIG), [parse_effect("cogging_torque:amplitude=0.05,harmonic=6")]
    for seed, name in enumerate(RECORDINGS):
        write(simulate(rig, "fast_reversals", seed=seed, effects=hidden).trace, folder / name)
    for seed, name in enumerate(("run1", "run2")):
        write(simulate(rig, "fast_reversals", seed=10 + seed, effects=hidden).trace, folder / f"{name}.csv.gz")
    (folder / "robot.xml").write_text(MJCF, encoding="utf-8")
    write_log(folder / "log.csv", log())
    rows = ["file,rig,axis,time", "run1.csv,rig.toml,press,1", "run2.csv,rig.toml,press,2"]
    (folder / "fleet.csv").write_text("\n".join(rows), encoding="utf-8")
    shutil.copytree(asset("data", "rigs"), folder / "data" / "rigs")
    shutil.copy(RIG, folder / "rig.toml")
    return folder


@pytest.fixture(scope="module")
def done():
    """Commands that pages have done in the folder that several suppose."""
    return set()


def rig_alone():
    shutil.copy(RIG, "rig.toml")


def days():
    """An axis of one's own, recorded on six days."""
    Path("rig.toml").write_text(OWN_RIG, encoding="utf-8")
    for seed, day in enumerate(DAYS):
        write(again(seed), Path(f"{day}.csv"))


def students():
    rig_alone()
    Path("my_folder").mkdir()
    for name in ("recording.trace", "my_folder/JLoadAndFriction.trace"):
        write(simulate(load_rig(asset("data", "rigs", "lab.toml")), "fast_reversals").trace, Path(name))


def checked():
    assert Path("check.json").exists()
    assert Path("check.xml").exists()


def reported():
    page = read_document(Path("found") / "report.json")
    assert page.verdict.startswith("Cogging torque was missing")
    assert "amplitude 0.05" in page.answers["What was missing?"]
    assert page.tone == "sure"
    written = ("found/report.html", "result/identification.pdf", "replay.html", "simulated.html", "inspected.html")
    for path in (*written, "pages.js"):
        assert Path(path).stat().st_size > 1000
    assert Path("result/identification.pdf").read_bytes().startswith(b"%PDF")


def driven():
    cogging = np.genfromtxt(Path("tables") / "cogging.csv", delimiter=",", names=True)
    assert np.abs(cogging["torque_Nm"]).max() == pytest.approx(0.05, rel=0.02)
    motion = np.genfromtxt("motion.csv", delimiter=",", names=True)
    assert motion["time_s"][-1] > 4.0
    assert np.diff(motion["time_s"]) == pytest.approx(1e-3)
    travelled = np.cumsum(motion["velocity_rads"]) * 1e-3
    np.testing.assert_allclose(motion["position_rad"], travelled, atol=0.1)


class Page(NamedTuple):
    """What a page supposes, None for the folder that several suppose, and what is there when its commands have run."""

    before: Callable[[], None] | None = None
    after: Callable[[], None] = lambda: None
    slow: bool = False


HERE = {
    "README.md": Page(),
    "docs/check.md": Page(days, checked),
    "docs/diagnose.md": Page(),
    "docs/drive.md": Page(rig_alone, driven),
    "docs/effects.md": Page(),
    "docs/identify.md": Page(),
    "docs/index.md": Page(slow=True),
    "docs/lab.md": Page(students, slow=True),
    "docs/notebooks/first_model.md": Page(),
    "docs/notebooks/fleet.md": Page(),
    "docs/report.md": Page(rig_alone, reported),
    "docs/tutorial.md": Page(),
}
#: Pages of which several tests check what came of the commands, and where those are.
ELSEWHERE = {
    "docs/engines.md": "export/test_engines.py",
    "docs/export.md": "export/test_in_a_robot.py",
    "docs/fleet.md": "fleet/test_fleet.py",
    "docs/recordings.md": "test_recordings_manual.py",
    "docs/robot.md": "joints/test_robot.py",
    "docs/servo.md": "servos/test_servo.py",
    "docs/validate.md": "validation/test_command.py",
    "docs/view.md": "view/test_command.py",
}


#: Commands that are run where those pages are tested.
OF_OTHERS = {line for name in ELSEWHERE for line in bench_commands(PAGES[name])}


def brief(line):
    """Monte Carlo with one recording, of MuJoCo; a draft is not written over the rig of the next command; a motion of
    2 s in place of 7.
    """
    if line in OF_OTHERS:
        return ""
    line = re.sub(r"--rigs \d+", "--rigs 1 --workers 1 --seed 4", line)
    line += " --profile fast_reversals" * (line.startswith("bench simulate") and "--profile" not in line)
    return line.replace("--draft rig.toml", "--draft draft.toml")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if page.slow else []) for name, page in HERE.items()]
)
def test_the_commands_of_a_page_run(name, supposed, done, tmp_path, monkeypatch):
    page = HERE[name]
    if page.before is None:  # what another page has done in the same folder is not done again
        monkeypatch.chdir(supposed)
        lines = [line for line in bench_commands(PAGES[name]) if line not in done]
        done.update(lines)
    else:
        monkeypatch.chdir(tmp_path)
        page.before()
        lines = bench_commands(PAGES[name])
    run_commands(lines, brief)
    page.after()


def test_the_example_of_the_manual_of_reports_writes_a_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run_examples("docs/report.md")
    assert "Nothing has changed." in (tmp_path / "axis7" / "report.html").read_text(encoding="utf-8")
