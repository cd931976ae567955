"""Grade a student's answers against the sealed truth: units checked, known mistakes recognised by their figures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from bench.course.answers import ASKED, Asked
from bench.course.mistakes import MISTAKES, Mistake
from bench.course.students import SCHEMA, seal
from bench.course.submission import Answer, Submission
from bench.errors import InputError
from bench.files import read_text
from bench.structured import parse_json
from bench.units import convert, dimensionality, same_dimension

#: An answer is a mistake's figure within the tolerance of a right one; E, which has none, within this share of it.
OF_ERROR = 0.04

Verdict = Literal["right", "wrong", "wrong unit", "not answered", "not judged"]


@dataclass(frozen=True)
class Mark:
    """One answer and what is to be said of it.

    Attributes:
        asked: quantity.
        given: as it was handed in.
        value: the same in the form's unit; NaN without one.
        expected: what the course's way gives on the student's recordings, in that unit.
        verdict: right, wrong, in a unit of another dimension, not answered, or not judged.
        mistake: that its figure tells, or None.
    """

    asked: Asked
    given: Answer | None
    value: float
    expected: float
    verdict: Verdict
    mistake: Mistake | None = None


@dataclass(frozen=True)
class Graded:
    """All marks of one student."""

    student: str
    marks: tuple[Mark, ...]

    @property
    def right(self) -> int:
        """Answers that are right."""
        return sum(mark.verdict == "right" for mark in self.marks)

    @property
    def judged(self) -> int:
        """Answers that are asked for and judged."""
        return sum(mark.verdict != "not judged" for mark in self.marks)

    @property
    def mistakes(self) -> tuple[Mistake, ...]:
        """Known mistakes, each once."""
        return tuple(dict.fromkeys(mark.mistake for mark in self.marks if mark.mistake is not None))


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


def grade(submission: Submission, known: Mapping[str, Any]) -> Graded:
    """Mark every quantity of the form.

    Args:
        submission: of one student.
        known: of the same student, from `read_truth_of_class`.

    Raises:
        InputError: the submission's student is not in it; names the nearest.
    """
    if submission.student not in known:
        allowed = f"allowed: {', '.join(sorted(known))}"
        raise InputError(f"{submission.source}: student", f"found '{submission.student}'", allowed)
    of_student = known[submission.student]
    marks = [_mark(asked, submission.answers.get(asked.name), of_student) for asked in ASKED]
    named = _named(marks, of_student["mistakes"])
    return Graded(submission.student, tuple(named))


def _mark(asked: Asked, given: Answer | None, known: Mapping[str, Any]) -> Mark:
    expected = _number(known["expected"].get(asked.name))
    if given is None:
        return Mark(asked, None, math.nan, expected, "not answered" if asked.tolerance is not None else "not judged")
    if not _fits(given.unit, asked.unit):
        return Mark(asked, given, math.nan, expected, "wrong unit")
    value = float(convert(np.asarray(given.value), given.unit or asked.unit, asked.unit))
    if asked.tolerance is None:
        return Mark(asked, given, value, expected, "not judged")
    references = (expected, _number(known["truth"].get(asked.name)))
    right = any(abs(value - reference) <= _reach(asked, reference) for reference in references)
    return Mark(asked, given, value, expected, "right" if right else "wrong")


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _fits(unit: str, wanted: str) -> bool:
    """Whether a unit is one of the quantity's; none is the form's own."""
    try:
        return not unit or same_dimension(unit, wanted)
    except ValueError:
        return False


def _reach(asked: Asked, reference: float) -> float:
    return (asked.tolerance or 0.0) * (abs(reference) or asked.near_zero)


def _named(marks: Sequence[Mark], figures: Mapping[str, Sequence[Mapping[str, float]]]) -> list[Mark]:
    """Wrong answers of a task with the mistake whose figures they are, the nearest where several would do.

    A task is made in one way: all that a mistake changes in it must be as the mistake has it, E among them.
    """
    named = list(marks)
    for task in dict.fromkeys(mark.asked.task for mark in marks):
        rows = [k for k, mark in enumerate(marks) if mark.asked.task == task and math.isfinite(marks[k].value)]
        if not any(marks[k].verdict == "wrong" for k in rows):
            continue
        found: list[tuple[int, float, Mistake]] = []
        for mistake in MISTAKES:
            for way in figures.get(mistake.name, ()):
                agreed, apart = _agreement([marks[k] for k in rows], way)
                if agreed:
                    found.append((-agreed, apart, mistake))
        if not found:
            continue
        # more answers explained first, then the nearer
        best = min(found, key=lambda entry: entry[:2])[2]
        for k in rows:
            if marks[k].verdict == "wrong" and _is_figure(marks[k], figures[best.name]):
                named[k] = Mark(marks[k].asked, marks[k].given, marks[k].value, marks[k].expected, "wrong", best)
    return named


def _is_figure(mark: Mark, ways: Sequence[Mapping[str, float]]) -> bool:
    return any(_apart(mark, way) <= 1.0 for way in ways)


def _agreement(marks: Sequence[Mark], way: Mapping[str, float]) -> tuple[int, float]:
    """How many wrong answers are a mistake's figures, and how far all are from them in shares of what is allowed."""
    apart = [(mark, _apart(mark, way)) for mark in marks]
    explained = [value for mark, value in apart if mark.verdict == "wrong" and value <= 1.0]
    within = [min(value, 10.0) ** 2 for mark, value in apart if mark.verdict != "right" or value > 1.0]
    return len(explained), math.sqrt(sum(within) / len(within)) if within else 0.0


def _apart(mark: Mark, way: Mapping[str, float]) -> float:
    """Distance of an answer from a mistake's figure, 1 where it is just recognised."""
    figure = _number(way.get(mark.asked.name))
    if not math.isfinite(figure) or figure == 0.0:
        return math.inf
    return abs(mark.value / figure - 1.0) / (mark.asked.tolerance or OF_ERROR)


def unit_advice(mark: Mark) -> str:
    """What a wrong unit measures, and what is asked for."""
    unit = mark.given.unit if mark.given is not None else ""
    try:
        found = dimensionality(unit)
    except ValueError:
        return f"'{unit}' is no unit; give {mark.asked.unit}, or another unit of the same quantity."
    return f"'{unit}' measures {found}; give {mark.asked.unit}, or another unit of the same quantity."
