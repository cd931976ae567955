"""`bench lab --grade`: a table for the teacher, as CSV and HTML, and a page for each student."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from rich.table import Table

from bench.course.grade import GradedAnswer, GradedClass
from bench.files import write_text
from bench.names import cell

TITLE = "Industrial Drives, Part 2: grades"


def write_grades(graded: GradedClass, out: Path) -> list[Path]:
    """Write `grades.csv`, `grades.html` and a page for each student into a folder; returns the paths."""
    environment = Environment(
        loader=PackageLoader("bench.course"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    environment.globals.update(shown=shown, off=off)
    paths = [out / "grades.csv", out / "grades.html"]
    write_text(paths[0], grades_csv(graded))
    teacher = environment.get_template("grades.html.j2")
    write_text(paths[1], teacher.render(title=TITLE, graded=graded))
    page = environment.get_template("student.html.j2")
    for one in graded.students:
        paths.append(out / "students" / f"student-{one.student}.html")
        write_text(paths[-1], page.render(title=TITLE, one=one))
    return paths


def grades_csv(graded: GradedClass) -> str:
    """A row an answer."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(["student", "task", "quantity", "given", "unit", "expected", "in", "verdict", "mistake"])
    for one in graded.students:
        for answer in one.answers:
            asked, given = answer.question, answer.given
            value, unit = (given.value, given.unit or asked.unit) if given is not None else ("", "")
            mistake = answer.mistake.name if answer.mistake is not None else ""
            expected = f"{answer.expected:.6g}", asked.unit
            row = (one.student, asked.task, asked.name, value, unit, *expected, answer.verdict, mistake)
            writer.writerow([cell(str(content)) for content in row])
    return buffer.getvalue()


def shown(answer: GradedAnswer) -> str:
    """The answer as it was given."""
    if answer.given is None:
        return ""
    return f"{answer.given.value:.6g} {answer.given.unit or answer.question.unit}"


def off(answer: GradedAnswer) -> str:
    """How far the answer is from what is expected."""
    return "" if answer.off is None else f"{answer.off:+.2%}"


def grades_table(graded: GradedClass) -> Table:
    """A row a student: answers that are right, and mistakes."""
    table = Table(title="Grades", title_justify="left")
    for heading in ("student", "right", "mistakes"):
        table.add_column(heading)
    for one in graded.students:
        words = [mistake.name for mistake in one.mistakes]
        unknown = [answer.question.name for answer in one.wrong if answer.mistake is None]
        if unknown:
            words.append(f"wrong, not known why: {', '.join(unknown)}")
        table.add_row(one.student, f"{one.right} of {one.judged}", "; ".join(words))
    return table
