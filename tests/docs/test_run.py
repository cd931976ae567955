"""Commands of the pages that have no test of their own run as they stand, in a folder as the page supposes it."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from bench.assets import asset
from bench.effects.present import parse_effect
from bench.plant.simulate import simulate
from bench.rig.rig import load_rig
from bench.trace.write import write
from tests.diagnosis.command import started
from tests.docs.pages import PAGES, bench_commands
from tests.export.two_links import MJCF, log, write_log

#: Pages that are run here, and those of them that take longer.
RUN_HERE = (
    "README.md",
    "docs/tutorial.md",
    "docs/identify.md",
    "docs/diagnose.md",
    "docs/effects.md",
    "docs/notebooks/first_model.md",
    "docs/notebooks/fleet.md",
)
SLOW = ("docs/index.md", "docs/lab.md")
RECORDINGS = ("recording.csv", "monday.csv", "tuesday.csv", "wednesday.csv", "run1.csv", "run2.csv")
RIG = asset("data", "rigs", "sh30701p.toml")


@pytest.fixture(scope="module")
def supposed(tmp_path_factory):
    """A rig that can be simulated, recordings of it that hide a cogging torque, a robot and its log."""
    folder = tmp_path_factory.mktemp("supposed")
    rig, hidden = load_rig(RIG), [parse_effect("cogging_torque:amplitude=0.05,harmonic=6")]
    for seed, name in enumerate(RECORDINGS):
        write(simulate(rig, seed=seed, effects=hidden).trace, folder / name)
    for seed, name in enumerate(("run1", "run2")):
        write(simulate(rig, seed=10 + seed, effects=hidden).trace, folder / f"{name}.csv.gz")
    (folder / "robot.xml").write_text(MJCF, encoding="utf-8")
    write_log(folder / "log.csv", log())
    rows = ["file,rig,axis,time", "run1.csv,rig.toml,press,1", "run2.csv,rig.toml,press,2"]
    (folder / "fleet.csv").write_text("\n".join(rows), encoding="utf-8")
    shutil.copytree(asset("data", "rigs"), folder / "data" / "rigs")
    return folder


@pytest.mark.parametrize("page", [*RUN_HERE, pytest.param("docs/index.md", marks=pytest.mark.slow)])
def test_the_commands_of_a_page_run(page, supposed, tmp_path, monkeypatch):
    """Monte Carlo with two recordings in the place of many; a draft of a rig is completed by its reader."""
    folder = tmp_path / "here"
    shutil.copytree(supposed, folder)
    monkeypatch.chdir(folder)
    bench = started(folder)
    shutil.copy(RIG, "rig.toml")
    for line in bench_commands(PAGES[page]):
        assert bench(*shlex.split(re.sub(r"--rigs \d+", "--rigs 2", line))[1:]) == 0, line
        if "--draft" in line:
            shutil.copy(RIG, "rig.toml")


@pytest.mark.slow
def test_the_commands_of_the_course_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bench = started(tmp_path)
    axis = load_rig(asset("data", "rigs", "lab.toml"))
    shutil.copy(RIG, "rig.toml")
    Path("my_folder").mkdir()
    for name in ("recording.trace", "my_folder/JLoadAndFriction.trace"):
        write(simulate(axis, "fast_reversals").trace, Path(name))
    for line in bench_commands(PAGES["docs/lab.md"]):
        assert bench(*shlex.split(line)[1:]) == 0, line
