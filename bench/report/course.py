"""`bench lab`: do the course on a folder's recordings, and write its report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rich import box
from rich.table import Table

from bench.lab.course import course
from bench.lab.recordings import Recordings
from bench.lab.result import NotDone
from bench.report.lab import Results, write_lab_report
from bench.report.section import section


@dataclass(frozen=True)
class CourseReport:
    """Results of every task, and the files of the report."""

    results: Results
    files: list[Path]


def report_course(data: Path | None, out: Path, progress: Callable[[float], None]) -> CourseReport:
    """Do the course and write `lab.html` and `lab.pdf`.

    Args:
        data: folder with a student's recordings, or None for the synthetic ones.
        out: folder of the report.
        progress: called with the share done.

    Raises:
        InputError: no such folder, or one that cannot be written to.
    """
    recordings = Recordings.in_folder(data)
    results = course(recordings, lambda share: progress(0.7 * share))
    missing = sum(isinstance(result, NotDone) for result in results)
    origin = "Synthetic recordings of the rig in MuJoCo" if data is None else f"Recordings in {data}"
    about = [f"{origin}; axis: {recordings.rig.name}. {len(results) - missing} of {len(results)} sections done."]
    if data is None:
        about.append("Where a truth stands beside a number, it is the value that the axis was simulated with.")
    files = write_lab_report(out, results, about, lambda share: progress(0.7 + 0.3 * share))
    return CourseReport(results, files)


def course_table(results: Results) -> Table:
    """Every number with its unit, beside its truth where that is known; of what was not done, what is missing."""
    table = Table(box=box.SIMPLE_HEAD, title="Lab course", title_justify="left")
    table.add_column("task", no_wrap=True)
    table.add_column("quantity")
    for heading in ("value", "truth", "error"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for printed in map(section, results):
        if printed.missing:
            table.add_row(printed.key, f"not done: {printed.missing}", style="yellow")
        for k, row in enumerate(printed.rows):
            table.add_row(printed.key if k == 0 else "", row.name, row.value, row.truth, row.error, row.unit)
    return table
