"""`bench lab --grade`: a table for the teacher, as CSV and a page, and a page for each student."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from bench.course.grade import GradedAnswer, GradedClass, GradedStudent
from bench.files import write_text
from bench.names import cell
from bench.report.document import Document, Neighbour, Neighbours, Paragraph, Points, Section, Table, table
from bench.report.html import html

TITLE = "Industrial Drives, Part 2: grades"


def write_grades(graded: GradedClass, out: Path) -> list[Path]:
    """Write `grades.csv`, `grades.html` and a page for each student into a folder; returns the paths."""
    contents = {"grades.csv": grades_csv(graded), "grades.html": html(class_document(graded))}
    contents |= {_page(one): html(student_document(one)) for one in graded.students}
    for name, content in contents.items():
        write_text(out / name, content)
    return [out / name for name in contents]


def _page(one: GradedStudent) -> str:
    return f"students/student-{one.student}.html"


def class_document(graded: GradedClass) -> Document:
    """All students: what is right, what is wrong by how much, which mistakes; whose form is missing or not read."""
    rows = [
        (
            one.student,
            f"{one.right} of {one.judged}",
            ", ".join(f"{answer.question.name} {_off(answer)}".strip() for answer in one.wrong),
            ", ".join(mistake.name for mistake in one.mistakes),
        )
        for one in graded.students
    ]
    pages = tuple(Neighbour(name=_page(one), about=f"student {one.student}") for one in graded.students)
    missing = f"No submission of: {', '.join(graded.missing)}."
    return Document(
        title=TITLE,
        subject=TITLE,
        verdict=f"{len(graded.students)} forms graded, {len(graded.unread)} not.",
        tone="open" if graded.missing or graded.unread else "sure",
        answers={},
        sections=(
            Section(
                key="students",
                heading="Students",
                blocks=(
                    *((Paragraph(text=missing),) if graded.missing else ()),
                    *((Points(items=tuple(map(str, graded.unread))),) if graded.unread else ()),
                    table("Answers", ("student", "right", "wrong~", "mistakes~"), rows),
                    Neighbours(files=pages),
                ),
            ),
        ),
    )


def student_document(one: GradedStudent) -> Document:
    """One student's answers, each with what is to be said of it; what is wrong is marked."""
    rows = [
        (answer.question.task, answer.question.name, _given(answer), answer.verdict, answer.remark)
        for answer in one.answers
    ]
    wrong = [place for place, answer in enumerate(one.answers) if answer in one.wrong]
    answers = table("Answers", ("task", "quantity", "your answer", "verdict", "remark~"), rows, wrong)
    return Document(
        title=f"{TITLE}, student {one.student}",
        subject=TITLE,
        verdict=f"Student {one.student}: {one.right} of {one.judged} right",
        tone="open" if one.wrong else "sure",
        answers={},
        sections=(Section(key="answers", heading="Answers", blocks=(answers,)),),
    )


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


def grades_table(graded: GradedClass) -> Table:
    """A row a student: answers that are right, and mistakes."""
    rows = []
    for one in graded.students:
        words = [mistake.name for mistake in one.mistakes]
        unknown = [answer.question.name for answer in one.wrong if answer.mistake is None]
        if unknown:
            words.append(f"wrong, not known why: {', '.join(unknown)}")
        rows.append((one.student, f"{one.right} of {one.judged}", "; ".join(words)))
    return table("Grades", ("student", "right", "mistakes~"), rows)


def _given(answer: GradedAnswer) -> str:
    """The answer as it was given."""
    if answer.given is None:
        return ""
    return f"{answer.given.value:.6g} {answer.given.unit or answer.question.unit}"


def _off(answer: GradedAnswer) -> str:
    """How far the answer is from what is expected."""
    return "" if answer.off is None else f"{answer.off:+.2%}"
