"""Grade a class against its sealed truth: units checked, mistakes known by their figures; grades as pages and CSV."""

from __future__ import annotations

import hmac
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any, Literal

from bench.course.explain import NOT_KNOWN, SURE, GradedAnswer, explanation
from bench.course.mistakes import AS_THE_TEXT_SAYS
from bench.course.submission import (
    BY_HAND,
    QUESTIONS,
    GivenAnswer,
    Question,
    Submission,
    find_submissions,
    read_submission,
    readings,
)
from bench.course.suspicion import Suspicion, suspicion_csv, suspicions
from bench.errors import InputError
from bench.files import read_text, write_text
from bench.report.document import AnyPart, Document, Paragraph, Points, Table, neighbours, section, table
from bench.report.html import html
from bench.structured import csv_of_texts, parse_json

TITLE = "Industrial Drives, Part 2: grades"
#: Schema of the truth of a class.
SEALED = "bench.lab.class/3"
#: Which acceleration of task 9 is right: as in the text, half a sample late, or synchronised with the speed.
Acceleration = Literal["either", "text", "synchronised"]
AS_THE_TEXT = (
    "Right, as in the text: the backward difference (16) is half a sample late, and J·α of that half sample counts "
    "as friction. Synchronised by half a sample more it would be {}."
)
SYNCHRONISED = "The text's acceleration is asked for: the backward difference (16) without a further half sample."
#: An answer is a mistake's figure within the tolerance of a right one; E, which has none, within this share of it.
OF_ERROR = 0.04


@dataclass(frozen=True)
class GradedStudent:
    """All graded answers of one student."""

    student: str
    answers: tuple[GradedAnswer, ...]

    @property
    def right(self) -> int:
        """Answers that are right."""
        return sum(answer.verdict == "right" for answer in self.answers)

    @property
    def judged(self) -> int:
        """Answers that are asked for and judged."""
        return sum(answer.verdict != "not judged" for answer in self.answers)

    @property
    def score(self) -> str:
        """How many are right of those judged, in words."""
        return f"{self.right} of {self.judged}"

    @property
    def wrong(self) -> tuple[GradedAnswer, ...]:
        """Answers that are wrong, by value or unit."""
        return tuple(answer for answer in self.answers if answer.verdict in ("wrong", "wrong unit"))

    @property
    def mistakes(self) -> list[str]:
        """Names of known mistakes, each once."""
        return list(dict.fromkeys(answer.mistake for answer in self.answers if answer.mistake))

    @property
    def page(self) -> str:
        """Name of its page."""
        return f"students/student-{self.student}.html"


@dataclass(frozen=True)
class GradedClass:
    """Grades of a class by student, and what the teacher has to see of it.

    Attributes:
        students: whose forms were graded.
        unread: forms that could not be read.
        missing: students that no form came from.
        suspicions: forms that are alike where they should not be.
    """

    students: tuple[GradedStudent, ...]
    unread: tuple[InputError, ...]
    missing: tuple[str, ...]
    suspicions: tuple[Suspicion, ...] = ()


def grade_class(
    submissions: Path, truth: Path, key: Path | None = None, acceleration: Acceleration = "either"
) -> GradedClass:
    """Grade every submission of a folder by a sealed truth; a bad one, or two of one student, leave the others alone.

    Args:
        submissions: folder of the filled forms; InputError without any.
        truth, key: as the class was recorded with; InputError as `read_truth_of_class`.
        acceleration: which of task 9 is right.
    """
    known = read_truth_of_class(truth, key)
    graded: dict[str, GradedStudent] = {}
    forms: dict[str, list[str]] = {}
    unread: list[InputError] = []
    for path in find_submissions(submissions):
        try:
            submission = read_submission(path)
            graded[submission.student] = grade(submission, known, acceleration)
        except InputError as error:
            unread.append(error)
        else:
            forms.setdefault(submission.student, []).append(submission.source)
    for student, paths in forms.items():
        if len(paths) > 1:
            del graded[student]
            found = f"found {len(paths)} of student {student} ({', '.join(paths)})"
            unread.append(InputError(submissions, found, "keep one of them"))
    students = tuple(one for _, one in sorted(graded.items()))
    alike = suspicions({one.student: one.answers for one in students}, known)
    return GradedClass(students, tuple(unread), tuple(sorted(set(known) - set(forms))), tuple(alike))


def seal(content: Mapping[str, Any], key: str) -> str:
    """Code by which a truth's content can be distinguished from a changed one, by whoever has the key
    (HMAC-SHA-256)."""
    return hmac.digest(key.encode(), json.dumps(content, sort_keys=True).encode(), "sha256").hex()


def key_path(truth: Path) -> Path:
    """Where the key of a truth's seal is, unless it is kept elsewhere: `class.truth.json` has `class.truth.key`."""
    return truth.with_suffix(".key")


def read_truth_of_class(path: Path, key: Path | None = None) -> Mapping[str, Any]:
    """Truth, expected answers and figures of mistakes by student, as `bench lab --record --students` wrote them.

    Raises InputError where there is no such file, one that was changed, or another key.
    """
    advice = "give the file that bench lab --record FOLDER --students N wrote next to FOLDER"
    try:
        content = parse_json(read_text(path, "a truth of a class"), path)
    except InputError as error:
        raise InputError(path, error.found, advice) from error
    if not isinstance(content, dict) or content.get("schema") != SEALED:
        raise InputError(path, "is no truth of a class", advice)
    given, key = str(content.pop("seal", None)), key or key_path(path)
    right = seal(content, read_text(key, "the key that was written with the class, or name it with --key").strip())
    if not hmac.compare_digest(given.encode(), right.encode()):
        raise InputError(path, f"its seal does not fit it and the key {key}: one of them was changed", advice)
    return content["students"]


def grade(submission: Submission, known: Mapping[str, Any], acceleration: Acceleration = "either") -> GradedStudent:
    """Grade every quantity of a student's form by `read_truth_of_class`; InputError without the student."""
    if submission.student not in known:
        allowed = f"allowed: {', '.join(sorted(known))}"
        raise InputError(f"{submission.source}: student", f"found '{submission.student}'", allowed)
    of_student = known[submission.student]
    graded = [_graded(question, submission.answers.get(question.name), of_student) for question in QUESTIONS]
    graded = _accelerated(graded, of_student, acceleration)
    tasks = [list(of_task) for _, of_task in groupby(graded, lambda answer: answer.question.task)]
    explanations = [explanation(of_task, of_student) for of_task in tasks]
    sure = [{*one.names} - {NOT_KNOWN} if one is not None and one.odds >= SURE else set() for one in explanations]
    answers = []
    for of_task, found, alone in zip(tasks, explanations, sure, strict=True):
        if found is not None and not alone:  # what a task does not decide the others may settle
            found = explanation(of_task, of_student, set().union(*sure))
        given = found.given if found is not None else ()
        answers += [
            replace(answer, explained=found if answer.verdict == "wrong" and answer.question.name in given else None)
            for answer in of_task
        ]
    return GradedStudent(submission.student, tuple(answers))


def _graded(question: Question, given: GivenAnswer | None, known: Mapping[str, Any]) -> GradedAnswer:
    expected, true = (known[name].get(question.name, math.nan) for name in ("expected", "truth"))
    own = known["tolerance"].get(question.name, 0.0)
    tolerance = OF_ERROR if question.tolerance is None else max(question.tolerance, own)
    if given is None:
        return GradedAnswer(question, None, math.nan, expected, "not answered", tolerance)
    try:
        values = readings(given, question)
    except ValueError:
        return GradedAnswer(question, given, math.nan, expected, "wrong unit", tolerance)

    def off(value: float) -> float:
        """Share that a value is off what is expected or the truth, whichever is nearer; inf where neither is known."""
        shares = (abs(value - one) / (abs(one) or question.near_zero or 1.0) for one in (expected, true))
        return min((share for share in shares if math.isfinite(share)), default=math.inf)

    value = min(values, key=off)
    verdict = "not judged" if question.tolerance is None else "right" if off(value) <= tolerance else "wrong"
    return GradedAnswer(question, given, value, expected, verdict, tolerance)


def _accelerated(
    graded: list[GradedAnswer], known: Mapping[str, Any], acceleration: Acceleration
) -> list[GradedAnswer]:
    """Friction of task 9 by the acceleration that is right: the text's, the synchronised one, or either."""
    if acceleration == "synchronised":
        return graded
    ways = [figures for names, figures in known["mistakes"] if len(names) == 1 and names[0] in AS_THE_TEXT_SAYS]
    asked = [one for one in graded if one.question.name.startswith("K_fric") and math.isfinite(one.value)]

    def near(one: GradedAnswer, figures: Mapping[str, float]) -> bool:
        figure = figures.get(one.question.name, math.nan)
        return abs(one.value - figure) <= one.tolerance * max(abs(figure), abs(one.expected))

    text = bool(asked) and any(all(near(one, figures) for one in asked) for figures in ways)
    changed = []
    for one in graded:
        if one in asked and text and one.verdict == "wrong":
            note = AS_THE_TEXT.format(f"{one.expected:.3g} {one.question.unit}")
            one = replace(one, verdict="right", note=note)
        elif one in asked and acceleration == "text" and not text and one.verdict == "right":
            one = replace(one, verdict="wrong", note=SYNCHRONISED)
        changed.append(one)
    return changed


def write_grades(graded: GradedClass, out: Path) -> list[Path]:
    """Write `grades.csv`, `grades.html` and a page for each student into a folder; returns the paths."""
    contents = {"grades.csv": grades_csv(graded), "grades.html": html(class_document(graded))}
    contents |= {"suspicion.csv": suspicion_csv(graded.suspicions), "by_hand.csv": sheet_csv(graded)}
    contents |= {one.page: html(student_document(one)) for one in graded.students}
    for name, content in contents.items():
        write_text(out / name, content)
    return [out / name for name in contents]


def class_document(graded: GradedClass) -> Document:
    """All students: what is right, what is wrong by how much, which mistakes; whose form is missing or not read."""
    blocks: list[AnyPart] = []
    if graded.missing:
        blocks.append(Paragraph(text=f"No submission of: {', '.join(graded.missing)}."))
    if graded.unread:
        blocks.append(Points(items=tuple(map(str, graded.unread))))
    blocks.append(grades_table(graded))
    blocks.append(neighbours({one.page: f"student {one.student}" for one in graded.students}))
    return Document(
        title=TITLE,
        subject=TITLE,
        verdict=f"{len(graded.students)} forms graded, {len(graded.unread)} not.",
        tone="open" if graded.missing or graded.unread else "sure",
        answers={},
        sections=(section("students", "Students", *blocks),),
    )


def student_document(one: GradedStudent) -> Document:
    """One student's answers, each with its assessment; what is wrong is marked."""
    rows = [(a.question.task, a.question.name, a.as_given, a.verdict, a.remark) for a in one.answers]
    wrong = [place for place, answer in enumerate(one.answers) if answer in one.wrong]
    answers = table("Answers", ("task", "quantity", "your answer", "verdict", "remark~"), rows, wrong)
    return Document(
        title=f"{TITLE}, student {one.student}",
        subject=TITLE,
        verdict=f"Student {one.student}: {one.score} right",
        tone="open" if one.wrong else "sure",
        answers={},
        sections=(section("answers", "Answers", answers),),
    )


def grades_csv(graded: GradedClass) -> str:
    """A row an answer."""
    rows = []
    for one in graded.students:
        for answer in one.answers:
            asked, given = answer.question, answer.given
            value, unit = (given.value, given.unit or asked.unit) if given is not None else ("", "")
            likelier = answer.explained.likelier if answer.explained is not None else ""
            row = one.student, asked.task, asked.name, value, unit, f"{answer.expected:.6g}", asked.unit
            rows.append((*row, answer.verdict, answer.mistake, likelier))
    head = ("student", "task", "quantity", "given", "unit", "expected", "in", "verdict", "mistake", "likelier")
    return csv_of_texts(head, rows)


def sheet_csv(graded: GradedClass) -> str:
    """A row for each student and task that is marked by hand, with what to look for and room for the marks."""
    rows = ((one.student, task, what, "") for one in graded.students for task, what in BY_HAND.items())
    return csv_of_texts(("student", "task", "look for", "marks"), rows)


def grades_table(graded: GradedClass) -> Table:
    """A row a student: how many answers are right, which are wrong and by how much, and known mistakes."""
    rows = []
    for one in graded.students:
        wrong = ", ".join(f"{answer.question.name} {answer.off}".strip() for answer in one.wrong)
        rows.append((one.student, one.score, wrong, ", ".join(one.mistakes)))
    return table("Grades", ("student", "right", "wrong~", "mistakes~"), rows)
