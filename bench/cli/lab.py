"""`bench lab`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast, get_args

from typer import BadParameter, Exit, Option

from bench.cli.common import list_files, printed, say, warn

if TYPE_CHECKING:
    from bench.course.report import CourseReport


def lab(
    data: Annotated[Path | None, Option(help="Folder of your recordings; else synthetic ones.")] = None,
    out: Annotated[Path, Option(help="Folder for the report, or the grades.")] = Path("bench_lab"),
    synthetic: Annotated[
        Path | None, Option("--record", help="Only simulate the course's recordings, into this folder.")
    ] = None,
    students: Annotated[int | None, Option(help="With --record: a folder and an axis of its own for each.")] = None,
    seed: Annotated[int, Option(min=0, help="With --record: of everything drawn.")] = 0,
    submissions: Annotated[
        Path | None, Option("--grade", help="Grade the filled forms in this folder; with --truth.")
    ] = None,
    truth: Annotated[Path | None, Option(help="Sealed truth that --students wrote.")] = None,
    key: Annotated[Path | None, Option(help="Key of its seal; preset: next to it, with the ending .key.")] = None,
    acceleration: Annotated[
        str, Option(help="With --grade: task 9 is right as in the text, synchronised, or either.")
    ] = "either",
    notebooks: Annotated[Path | None, Option(help="Only write a notebook for each task, into this folder.")] = None,
    folders: Annotated[
        Path | None, Option("--questions", help="Three questions for each student of this class' folder.")
    ] = None,
) -> None:
    """Do all tasks of the lab course; write one report as HTML, PDF and JSON. Or prepare and grade a class."""
    if synthetic is not None:
        from bench.course.record import record, record_class
        from bench.report.terminal import progress

        with progress("recording") as done:
            made = record(synthetic, seed, done) if students is None else record_class(synthetic, students, seed, done)
        list_files(made)
    elif submissions is not None:
        _grade(submissions, truth, key, out, acceleration)
    elif folders is not None:
        _ask(folders, out)
    elif notebooks is not None:
        from bench.course.notebooks import write_notebooks

        list_files(write_notebooks(notebooks))
    elif students is not None or truth is not None:
        raise BadParameter("--students goes with --record, --truth with --grade")
    elif not reported(data, out).usable:
        raise Exit(1)


def _grade(submissions: Path, truth: Path | None, key: Path | None, out: Path, acceleration: str) -> None:
    from bench.course.grade import Acceleration, grade_class, grades_table, write_grades

    if truth is None:
        raise BadParameter("--grade needs --truth FILE, which --record --students wrote")
    if acceleration not in (allowed := get_args(Acceleration)):
        raise BadParameter(f"--acceleration: found {acceleration}, allowed: {', '.join(allowed)}")
    graded = grade_class(submissions, truth, key, cast("Acceleration", acceleration))
    files = write_grades(graded, out)
    printed(grades_table(graded))
    for error in graded.unread:
        say(f"not graded: {error}", err=True)
    if graded.suspicions:
        say(f"pairs of forms with the same wrong answers: {len(graded.suspicions)}, see suspicion.csv", err=True)
    list_files(files[:3])
    if graded.unread:
        raise Exit(1)


def _ask(folder: Path, out: Path) -> None:
    from bench.course.colloquium import write_questions

    files, missing = write_questions(folder, out)
    for reason in missing:
        say(str(reason), err=True)
    list_files(files[-1:])
    if missing:
        raise Exit(1)


def reported(data: Path | None, out: Path) -> CourseReport:
    """Do the course, write its report and print its first numbers."""
    from bench.course.pdf import no_typst
    from bench.course.report import first_numbers, report_course
    from bench.report.terminal import progress

    with progress("lab course") as done:
        report = report_course(data, out, done)
    printed(first_numbers(report.results))
    list_files(report.files)
    warn([missing] if (missing := no_typst()) else [])
    return report
