"""`bench lab --grade`: a table for the teacher, as CSV and HTML, and a page for each student."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from rich.table import Table

from bench.course.grade import Graded, Mark, grade, read_truth_of_class, unit_advice
from bench.course.submission import find_submissions, read_submission
from bench.errors import InputError
from bench.files import write_text
from bench.names import cell

TITLE = "Industrial Drives, Part 2: grades"


def grade_class(submissions: Path, truth: Path, out: Path) -> tuple[list[Graded], list[InputError], list[Path]]:
    """Grade every submission of a folder and write the table and the pages.

    Args:
        submissions: folder.
        truth: sealed file.
        out: folder of the pages.

    Returns:
        Grades, what could not be read, and paths written.

    Raises:
        InputError: no submissions, no truth, or two submissions of one student.
    """
    known = read_truth_of_class(truth)
    graded: dict[str, Graded] = {}
    bad: list[InputError] = []
    sources: dict[str, Path] = {}
    for path in find_submissions(submissions):
        try:
            found = grade(read_submission(path), known)
        except InputError as error:
            bad.append(error)
            continue
        if found.student in graded:
            both = f"found two of student {found.student} ({sources[found.student]}, {path})"
            raise InputError(submissions, both, "leave one of them")
        graded[found.student], sources[found.student] = found, path
    missing = sorted(set(known) - set(graded))
    ordered = [graded[student] for student in sorted(graded)]
    return ordered, bad, _write(ordered, bad, missing, out)


def _write(graded: Sequence[Graded], bad: Sequence[InputError], missing: Sequence[str], out: Path) -> list[Path]:
    environment = Environment(
        loader=PackageLoader("bench.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    environment.globals.update(remark=remark, shown=shown, off=off)
    paths = [out / "grades.csv", out / "grades.html"]
    write_text(paths[0], _csv(graded))
    teacher = environment.get_template("grades.html.j2")
    write_text(paths[1], teacher.render(title=TITLE, graded=graded, bad=list(map(str, bad)), missing=missing))
    page = environment.get_template("student.html.j2")
    for one in graded:
        path = out / "students" / f"student-{one.student}.html"
        write_text(path, page.render(title=TITLE, one=one))
        paths.append(path)
    return paths


def _csv(graded: Sequence[Graded]) -> str:
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(["student", "task", "quantity", "given", "unit", "expected", "in", "verdict", "mistake"])
    for one in graded:
        for mark in one.marks:
            given = (mark.given.value, mark.given.unit or mark.asked.unit) if mark.given is not None else ("", "")
            mistake = mark.mistake.name if mark.mistake is not None else ""
            expected = f"{mark.expected:.6g}"
            row = [
                one.student,
                mark.asked.task,
                mark.asked.name,
                *given,
                expected,
                mark.asked.unit,
                mark.verdict,
                mistake,
            ]
            writer.writerow([cell(str(value)) for value in row])
    return buffer.getvalue()


def remark(mark: Mark) -> str:
    """What a student reads beside an answer."""
    if mark.mistake is not None:
        return f"{mark.mistake.name}: {mark.mistake.explanation}"
    if mark.verdict == "wrong unit":
        return unit_advice(mark)
    return {"wrong": "Off by more than other right ways would be; no mistake that is known gives this figure."}.get(
        mark.verdict, ""
    )


def shown(mark: Mark) -> str:
    """The answer as it was given."""
    if mark.given is None:
        return ""
    return f"{mark.given.value:.6g} {mark.given.unit or mark.asked.unit}"


def off(mark: Mark) -> str:
    """How far the answer is from what is expected."""
    if not math.isfinite(mark.value) or not mark.expected:
        return ""
    return f"{mark.value / mark.expected - 1.0:+.2%}"


def grades_table(graded: Sequence[Graded]) -> Table:
    """A row a student: answers that are right, and mistakes."""
    table = Table(title="Grades", title_justify="left")
    for heading in ("student", "right", "mistakes"):
        table.add_column(heading)
    for one in graded:
        wrong = [mark.asked.name for mark in one.marks if mark.verdict in ("wrong", "wrong unit") and not mark.mistake]
        words = [mistake.name for mistake in one.mistakes]
        if wrong:
            words.append(f"wrong, not known why: {', '.join(wrong)}")
        table.add_row(one.student, f"{one.right} of {one.judged}", "; ".join(words))
    return table
