"""`bench lab`: do the course on a folder's recordings, and write its report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rich import box
from rich.table import Table

from bench.course.course import RECORDED, course
from bench.course.cover import Cover
from bench.course.recordings import Recordings
from bench.course.result import NotDone, Task
from bench.files import held
from bench.report.handin import write_sources
from bench.report.lab import Results, write_lab_report
from bench.report.section import section


@dataclass(frozen=True)
class CourseReport:
    """Results of every task, and the files of the report."""

    results: Results
    files: list[Path]

    @property
    def usable(self) -> bool:
        """Whether any task that needs a recording was done."""
        return any(isinstance(result, Task) and result.key in RECORDED for result in self.results)


def report_course(data: Path | None, out: Path, progress: Callable[[float], None]) -> CourseReport:
    """Do the course and write `lab.json`, `lab.html` and `lab.pdf`, and the sources to hand in.

    Args:
        data: folder with a student's recordings, or None for the synthetic ones.
        out: folder of the report.
        progress: called with the share done.

    Raises:
        InputError: no such folder, a bad rig or group file in it, or a report's folder that cannot be written to.
    """
    recordings, cover = Recordings.in_folder(data), Cover.in_folder(data)
    results = course(recordings, lambda share: progress(0.7 * share))
    about = _about(recordings, results)
    with held(out):
        files = write_lab_report(
            out, results, about, lambda share: progress(0.7 + 0.3 * share), cover, recordings.rig.name
        )
        sources = write_sources(out / "sources", recordings, results)
    return CourseReport(results, [*sources, *files])


def _about(recordings: Recordings, results: Results) -> list[str]:
    done = [result for result in results if not isinstance(result, NotDone)]
    own = sum(not result.example for result in done)
    origin = (
        "Synthetic recordings of the rig in MuJoCo" if recordings.synthetic else f"Recordings in {recordings.folder}"
    )
    about = [
        f"{origin}; axis: {recordings.rig.name}. {own} of {len(results)} sections done on them, "
        f"{len(done) - own} on the embedded example, {len(results) - len(done)} not done.",
        "Beside every number stands where it comes from: the recording, the rig file, the motor's datasheet, "
        "the course, an "
        "assumption, a simulation, or the embedded example.",
    ]
    if recordings.synthetic:
        about.append("Where a truth stands beside a number, it is the value that the axis was simulated with.")
    return about


def course_table(results: Results) -> Table:
    """Every number with its unit, beside its truth where that is known; of what was not done, what is missing."""
    table = Table(box=box.SIMPLE_HEAD, title="Lab course", title_justify="left")
    table.add_column("task", no_wrap=True)
    table.add_column("quantity", overflow="fold")
    for heading in ("value", "truth", "error"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for printed in map(section, results):
        if printed.missing:
            table.add_row(printed.key, f"not done: {printed.missing}", style="yellow")
        for k, row in enumerate(printed.rows):
            key = printed.key if k == 0 else ""
            table.add_row(key, row.name, row.value, row.truth, row.error, row.unit)
    return table
