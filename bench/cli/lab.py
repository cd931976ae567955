"""`bench lab`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.console import console, tell_files


def lab(
    data: Annotated[Path | None, typer.Option("--data", help="Folder of your recordings; else synthetic ones.")] = None,
    out: Annotated[Path, typer.Option("--out", help="Folder for the report.")] = Path("bench_lab"),
    synthetic: Annotated[
        Path | None, typer.Option("--record", help="Only simulate the course's recordings, into this folder.")
    ] = None,
) -> None:
    """Do all tasks of the lab course; write one report as HTML and PDF."""
    from bench.lab.record import record
    from bench.report.course import course_table, report_course
    from bench.report.progress import progress

    if synthetic is not None:
        with progress("recording") as done:
            tell_files(record(synthetic, progress=done))
        return
    with progress("lab course") as done:
        report = report_course(data, out, done)
    console().print(course_table(report.results))
    tell_files(report.files)
    if not report.usable:
        raise typer.Exit(1)
