"""`bench lab`, run once for all tests that read its tasks, its report or what it prints."""

import contextlib
import io
import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest

from bench.assets import asset
from bench.cli.lab import reported
from bench.course.report import CourseReport


@dataclass(frozen=True)
class Lab:
    """What the command wrote, what it printed, and its report."""

    folder: Path
    printed: str
    report: CourseReport


@pytest.fixture(scope="session")
def lab(tmp_path_factory):
    """`bench lab --out here` on the synthetic recordings."""
    folder = tmp_path_factory.mktemp("lab")
    with contextlib.chdir(folder), contextlib.redirect_stdout(io.StringIO()) as printed:
        report = reported(None, Path("here"))
    return Lab(folder, printed.getvalue(), report)


@pytest.fixture(scope="session")
def done(lab):
    """Tasks of the course on the synthetic recordings by their key."""
    missed = [task for task in lab.report.results if task.reason is not None]
    assert not missed, [f"{task.key}: {task.reason}" for task in missed]
    return {task.key: task for task in lab.report.results}


def as_a_student_has_them(folder):
    """The course's recordings and flights, without any truth beside them, in a folder that is made; the folder."""
    return shutil.copytree(
        asset("data", "traces"), folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("*truth.json")
    )
