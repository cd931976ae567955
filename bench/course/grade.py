"""Grade a student's answers against the sealed truth: units checked, known mistakes recognised by their figures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from bench.course.answers import MISTAKES, QUESTIONS, Mistake, Question
from bench.course.students import SCHEMA, seal
from bench.course.submission import GivenAnswer, Submission, find_submissions, read_submission
from bench.errors import InputError
from bench.files import read_text
from bench.structured import parse_json
from bench.units import convert, dimensionality, same_dimension

#: An answer is a mistake's figure within the tolerance of a right one; E, which has none, within this share of it.
OF_ERROR = 0.04
#: A distance from a mistake's figure counts up to so many times what is allowed: one answer alone decides nothing.
FARTHEST = 10.0

Verdict = Literal["right", "wrong", "wrong unit", "not answered", "not judged"]
#: Figures of each student's mistake in each of its ways, by the mistake's name.
Figures = Mapping[str, Sequence[Mapping[str, float]]]


@dataclass(frozen=True)
class GradedAnswer:
    """One answer and what is to be said of it.

    Attributes:
        question: what was asked.
        given: as it was handed in.
        value: the same in the form's unit; NaN without one.
        expected: what the course's way gives on the student's recordings, in that unit.
        verdict: right, wrong, in a unit of another dimension, not answered, or not judged.
        mistake: that its figure tells, or None.
    """

    question: Question
    given: GivenAnswer | None
    value: float
    expected: float
    verdict: Verdict
    mistake: Mistake | None = None

    @property
    def off(self) -> float | None:
        """Share by which it is off what is expected; None where that cannot be told."""
        return self.value / self.expected - 1.0 if math.isfinite(self.value) and self.expected else None

    @property
    def remark(self) -> str:
        """What the student reads beside it."""
        if self.mistake is not None:
            return f"{self.mistake.name}: {self.mistake.explanation}"
        if self.verdict == "wrong unit" and self.given is not None:
            return f"{_measures(self.given.unit)}; give {self.question.unit}, or another unit of the same quantity."
        if self.verdict == "wrong":
            return "Off by more than other right ways would be; no mistake that is known gives this figure."
        return ""

    def from_figure(self, way: Mapping[str, float]) -> float:
        """Distance from a mistake's figure, 1 where it is just recognised."""
        figure = _number(way.get(self.question.name))
        if not math.isfinite(figure) or figure == 0.0:
            return math.inf
        return abs(self.value / figure - 1.0) / (self.question.tolerance or OF_ERROR)


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
    def wrong(self) -> tuple[GradedAnswer, ...]:
        """Answers that are wrong, by value or unit."""
        return tuple(answer for answer in self.answers if answer.verdict in ("wrong", "wrong unit"))

    @property
    def mistakes(self) -> tuple[Mistake, ...]:
        """Known mistakes, each once."""
        return tuple(dict.fromkeys(answer.mistake for answer in self.answers if answer.mistake is not None))


@dataclass(frozen=True)
class GradedClass:
    """Grades of a class by student, forms that could not be read, and students that none came from."""

    students: tuple[GradedStudent, ...]
    unread: tuple[InputError, ...]
    missing: tuple[str, ...]


def grade_class(submissions: Path, truth: Path) -> GradedClass:
    """Grade every submission of a folder.

    Args:
        submissions: folder.
        truth: sealed file.

    Raises:
        InputError: no submissions, no truth, or two submissions of one student.
    """
    known = read_truth_of_class(truth)
    graded: dict[str, tuple[GradedStudent, Path]] = {}
    unread: list[InputError] = []
    for path in find_submissions(submissions):
        try:
            found = grade(read_submission(path), known)
        except InputError as error:
            unread.append(error)
            continue
        if found.student in graded:
            both = f"found two of student {found.student} ({graded[found.student][1]}, {path})"
            raise InputError(submissions, both, "leave one of them")
        graded[found.student] = found, path
    students = tuple(graded[student][0] for student in sorted(graded))
    return GradedClass(students, tuple(unread), tuple(sorted(set(known) - set(graded))))


def read_truth_of_class(path: Path) -> Mapping[str, Any]:
    """Truth, expected answers and figures of mistakes by student, as `bench lab --record --students` wrote them.

    Raises:
        InputError: no such file, none of these, or one that was changed.
    """
    advice = "give the file that bench lab --record FOLDER --students N wrote beside FOLDER"
    try:
        content = parse_json(read_text(path, "a truth of a class"), path)
    except InputError as error:
        raise InputError(path, error.found, advice) from error
    if not isinstance(content, dict) or content.get("schema") != SCHEMA:
        raise InputError(path, "is no truth of a class", advice)
    if content.pop("seal", None) != seal(content):
        raise InputError(path, "was changed: its seal is broken", advice)
    return content["students"]


def grade(submission: Submission, known: Mapping[str, Any]) -> GradedStudent:
    """Grade every quantity of the form.

    Args:
        submission: of one student.
        known: of the same student, from `read_truth_of_class`.

    Raises:
        InputError: the submission's student is not in it; names those that are.
    """
    if submission.student not in known:
        allowed = f"allowed: {', '.join(sorted(known))}"
        raise InputError(f"{submission.source}: student", f"found '{submission.student}'", allowed)
    of_student = known[submission.student]
    graded = [_graded(question, submission.answers.get(question.name), of_student) for question in QUESTIONS]
    named: list[GradedAnswer] = []
    for task in dict.fromkeys(question.task for question in QUESTIONS):
        of_task = [answer for answer in graded if answer.question.task == task]
        named += _with_mistake(of_task, of_student["mistakes"])
    return GradedStudent(submission.student, tuple(named))


def _graded(question: Question, given: GivenAnswer | None, known: Mapping[str, Any]) -> GradedAnswer:
    expected = _number(known["expected"].get(question.name))
    judged = question.tolerance is not None
    if given is None:
        return GradedAnswer(question, None, math.nan, expected, "not answered" if judged else "not judged")
    if not _fits(given.unit, question.unit):
        return GradedAnswer(question, given, math.nan, expected, "wrong unit")
    value = float(convert(np.asarray(given.value), given.unit or question.unit, question.unit))
    references = (expected, _number(known["truth"].get(question.name)))
    right = any(abs(value - reference) <= _allowed(question, reference) for reference in references)
    return GradedAnswer(question, given, value, expected, ("right" if right else "wrong") if judged else "not judged")


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _allowed(question: Question, reference: float) -> float:
    return (question.tolerance or 0.0) * (abs(reference) or question.near_zero)


def _fits(unit: str, wanted: str) -> bool:
    """Whether a unit is one of the quantity's; none is the form's own."""
    try:
        return not unit or same_dimension(unit, wanted)
    except ValueError:
        return False


def _measures(unit: str) -> str:
    """What a wrong unit is one of."""
    try:
        return f"'{unit}' measures {dimensionality(unit)}"
    except ValueError:
        return f"'{unit}' is no unit"


def _with_mistake(answers: Sequence[GradedAnswer], figures: Figures) -> list[GradedAnswer]:
    """Answers of a task, the wrong ones with the mistake whose figures they are, the nearest where several would do.

    A task is made in one way: all that a mistake changes in it must be as the mistake has it, E among them.
    """
    valued = [answer for answer in answers if math.isfinite(answer.value)]
    found: list[tuple[int, float, Mistake]] = []
    for mistake in MISTAKES:
        for way in figures.get(mistake.name, ()):
            explained, apart = _agreement(valued, way)
            if explained:
                found.append((-explained, apart, mistake))
    if not found:
        return list(answers)
    # more answers explained first, then the nearer
    best = min(found, key=lambda entry: entry[:2])[2]
    ways = figures[best.name]
    return [replace(answer, mistake=best) if _is_figure(answer, ways) else answer for answer in answers]


def _is_figure(answer: GradedAnswer, ways: Sequence[Mapping[str, float]]) -> bool:
    return answer.verdict == "wrong" and any(answer.from_figure(way) <= 1.0 for way in ways)


def _agreement(answers: Sequence[GradedAnswer], way: Mapping[str, float]) -> tuple[int, float]:
    """How many wrong answers are a mistake's figures, and how far all are from them in shares of what is allowed."""
    explained = sum(_is_figure(answer, [way]) for answer in answers)
    apart = [(answer.verdict, answer.from_figure(way)) for answer in answers]
    counted = [min(value, FARTHEST) ** 2 for verdict, value in apart if verdict != "right" or value > 1.0]
    return explained, math.sqrt(sum(counted) / len(counted)) if counted else 0.0
