"""`bench lab`, run once for all tests that read its tasks, its report or what it prints."""

import shutil
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from bench.assets import asset
from bench.course import course as course_module
from bench.course import report as course_report
from bench.course import tracking
from tests.command import bench


@dataclass(frozen=True)
class Lab:
    """What the command left: its exit status, what it printed, and its results before they were printed."""

    folder: Path
    status: object
    printed: str
    results: list


@pytest.fixture(scope="session")
def lab(tmp_path_factory):
    """`bench lab --out here` on the synthetic recordings."""
    folder, reports = tmp_path_factory.mktemp("lab"), []

    def kept(*arguments, report=course_report.report_course):
        reports.append(report(*arguments))
        return reports[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(course_report, "report_course", kept)
        ended = bench("lab", "--out", "here")
    return Lab(folder, ended.status, ended.out, [*reports[0].results])


@pytest.fixture(scope="session")
def done(lab):
    """Tasks of the course on the synthetic recordings by their key."""
    missed = [task for task in lab.results if task.reason is not None]
    assert not missed, [f"{task.key}: {task.reason}" for task in missed]
    return {task.key: task for task in lab.results}


def as_a_student_has_them(folder):
    """The course's recordings and flights, without any truth beside them, in a folder that is made; the folder."""
    return shutil.copytree(
        asset("data", "traces"), folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("*truth.json")
    )


#: Tasks of which nothing depends on the folder but time: the simulation of the winding.
SLOW = {"11"}


def nearly(plant, references):
    """What an axis does that follows nine tenths of its references; a simulation would take a second."""
    return replace(references, position=0.9 * references.position)


@pytest.fixture
def quick(monkeypatch):
    """The command without what only simulates."""
    monkeypatch.setattr(tracking, "run", nearly)
    monkeypatch.setattr(course_module, "TASKS", [task for task in course_module.TASKS if task.key not in SLOW])
    # drawing takes seconds a folder, and test_report.py looks at what it draws
    whole = course_report.task_section

    def undrawn(result):
        return whole(replace(result, charts=()))

    monkeypatch.setattr(course_report, "task_section", undrawn)


@pytest.fixture
def numbers_alone(monkeypatch, quick):
    """The same without PDF and sources."""
    monkeypatch.setattr(course_report, "no_typst", lambda: "left out")
    monkeypatch.setattr(course_report, "write_sources", lambda *arguments: [])
