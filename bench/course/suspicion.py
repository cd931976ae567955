"""Forms that share wrong answers beyond what honest work does, for the teacher only: which two, and in which tasks.

What is compared are answers of the own recordings that are not derived from each other: J, both friction coefficients
and the errors of both least squares. An answer that is right, that a known mistake gives, or that the neighbour's
mistake would give on the own recordings, is honest work. Of all others the best match does not count, as one unknown
factor may bring it about. `python -m tests.studies.copied` measures both rates.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bench.arrays import Array
from bench.course.explain import GradedAnswer
from bench.course.submission import QUESTIONS
from bench.structured import csv_of_texts

#: Answers that are compared; J of task 6 serves where that of task 9 is missing.
COMPARED, INSTEAD = ("catapult_E", "J", "K_fric_w", "K_fric_0", "E"), {"J": "J_without_friction"}
#: A copied answer differs in its logarithm by one of these standard deviations: rounded, or changed on purpose.
JITTER = (0.002, 0.01)
#: Honest answers: probability that one is right, a known mistake's, the neighbour's mistake's, or of no known one; the
#: spread of the last two.
RIGHT, KNOWN, ALIKE, ANYTHING = 0.4, 0.2, 0.2, 0.2
SAME, NEAR, WIDE = 0.02, 0.15, 1.5
#: Share of the answers of a copied form that are copied, and log10 of how much likelier a suspected copy is.
COPIED, SUSPECT = 0.5, 3.5
#: Standard deviation of a right answer without a tolerance of its own.
OF_ERROR = 0.02


@dataclass(frozen=True)
class Suspicion:
    """Two forms that are alike where they should not be.

    Attributes:
        student, other: whose answers fit the own recordings worse than the other's, and the other.
        evidence: log10 of how much likelier a copy is than honest work.
        answers: names of the student's wrong answers that are the other's, by task.
    """

    student: str
    other: str
    evidence: float
    answers: Mapping[str, Sequence[str]]


def evidence(given: Array, expected: Array, deviation: Array, known: Array, others: Array, of_others: Array) -> Array:
    """log10 of how much likelier answers (n, q) are copies of others (m, q) than honest work, (n, m).

    Args:
        given: answers of each student, NaN where there is none.
        expected: by the own recordings, (n, q).
        deviation: of the logarithm of a right answer, (n, q).
        known: answers by known mistakes on the own recordings, (n, k, q); NaN where one gives none.
        others: answers that may have been copied.
        of_others: what is expected of their recordings, (m, q).
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        off = np.log(np.abs(given / expected))
        by_known = np.nan_to_num(_normal(np.log(given[:, None] / known), deviation[:, None]))
        counted = np.maximum(np.isfinite(known).sum(axis=1), 1)
        honest = RIGHT * _normal(off, deviation) + KNOWN * by_known.sum(axis=1) / counted
        honest += 0.25 * ANYTHING * sum(np.exp(-np.abs(off) / width) / width for width in (NEAR, WIDE))
        alike = np.log((given / expected)[:, None] / (others / of_others))
        copied = np.log(given[:, None] / others)
        same = ALIKE * np.nan_to_num(_normal(alike, np.array(SAME)))
        made = np.mean([_normal(copied, np.array(width)) for width in JITTER], axis=0)
        each = np.log10(1.0 - COPIED + COPIED * np.nan_to_num(made) / (honest[:, None] + same))
    each = np.where(np.isfinite(each), each, 0.0)
    return each.sum(axis=2) - each.max(axis=2, initial=0.0)


def _normal(off: Array, deviation: Array) -> Array:
    return np.exp(-0.5 * np.minimum((off / deviation) ** 2, 1400.0)) / (deviation * math.sqrt(2.0 * math.pi))


def suspicions(graded: Mapping[str, Sequence[GradedAnswer]], known: Mapping[str, Any]) -> list[Suspicion]:
    """Pairs of forms that are suspected, likeliest first; of who handed none in, what the recordings give serves.

    Args:
        graded: every answer of each student.
        known: truth of the class by student.
    """
    names, everyone = [*graded], [*graded, *(name for name in known if name not in graded)]
    answers = {name: {one.question.name: one for one in of} for name, of in graded.items()}
    values = {name: {key: one.value for key, one in of.items()} for name, of in answers.items()}
    values |= {name: known[name]["expected"] for name in everyone[len(names) :]}
    instead = {name: INSTEAD if math.isnan(values[name].get("J", math.nan)) else {} for name in everyone}

    def compared(of: Mapping[str, float], name: str) -> list[float]:
        return [of.get(instead[name].get(key, key), math.nan) for key in COMPARED]

    def deviations(name: str) -> list[float]:
        own = {key: 0.5 * one.tolerance for key, one in answers[name].items()}
        return [one if math.isfinite(one) else OF_ERROR for one in compared(own, name)]

    figures = [[compared(of, name) for _, of in known[name].get("mistakes", [])] or [[math.nan] * 5] for name in names]
    most = max(map(len, figures), default=0)
    padded = np.array([one + [[math.nan] * len(COMPARED)] * (most - len(one)) for one in figures])
    others = np.array([compared(values[name], name) for name in everyone])
    expected = np.array([compared(known[name]["expected"], name) for name in everyone])
    count = len(names)
    if not count:
        return []
    spread = np.array([deviations(name) for name in names])
    found = evidence(others[:count], expected[:count], spread, padded, others, expected)
    np.fill_diagonal(found, 0.0)
    pairs = sorted(((float(found[i, j]), names[i], everyone[j]) for i, j in np.argwhere(found > SUSPECT)), reverse=True)
    suspected: dict[frozenset[str], Suspicion] = {}
    for certain, student, other in pairs:
        matching: dict[str, list[str]] = {}
        for question in QUESTIONS:
            if _matches(answers[student][question.name], values[other].get(question.name)):
                matching.setdefault(question.task, []).append(question.name)
        suspected.setdefault(frozenset((student, other)), Suspicion(student, other, certain, matching))
    return [*suspected.values()]


def _matches(answer: GradedAnswer, other: float | None) -> bool:
    """Whether an answer that is not the own recordings' is another's."""
    if other is None or answer.verdict == "right" or answer.value * other <= 0.0:
        return False
    own = answer.verdict == "not judged" and abs(answer.value / answer.expected - 1.0) < answer.tolerance
    return not own and abs(math.log(answer.value / other)) < 3.0 * max(JITTER)


def suspicion_csv(found: Sequence[Suspicion]) -> str:
    """A row for each task of two forms that are alike; only the head where no two are."""
    rows = (
        (one.student, one.other, f"10^{one.evidence:.1f}", task, " ".join(names))
        for one in found
        for task, names in one.answers.items()
    )
    return csv_of_texts(
        ("student", "like student", "times likelier than honest work", "task", "the same wrong answers"), rows
    )
