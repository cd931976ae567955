"""What a student's answers of a task show of how they were made, and how much likelier that is than the next.

Each explanation has figures of its own for the answers; an answer lies about its figure as right ones do about theirs,
or, seldom, anywhere. Where none does, each answer is right or anything: "not known".
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Literal

from bench.course.mistakes import MISTAKES, SLIPS
from bench.course.submission import GivenAnswer, Question
from bench.units import dimensionality

#: Probability that a task was done with one mistake, with two, and in a way that is not known.
ONE, TWO, UNKNOWN = 1e-2, 1e-4, 1e-3
#: Probability of an answer that an explanation does not reach; of one that is right where nothing is known.
SLIPPED, HALF = 1e-3, 0.5
#: Any answer: width of the spread of its logarithm about what is expected.
WIDE = 1.5
#: An explanation so many times likelier than the next is named alone.
SURE = 20.0
#: A mistake made in another task, by one and the same function, is so many times likelier made in this one too.
CARRIED = 50.0
NOT_KNOWN = "not known"
#: What a student reads of each mistake.
WHY = {mistake.name: mistake.why for mistake in MISTAKES if mistake.name}

#: What a way of working gives, by the names of the form.
Figures = Mapping[str, float]
Verdict = Literal["right", "wrong", "wrong unit", "not answered", "not judged"]


@dataclass(frozen=True)
class Explanation:
    """How answers of a task were made.

    Attributes:
        names: of the mistakes, two where both were made; or NOT_KNOWN.
        odds: against the next explanation.
        next: its names.
        given: answers that it gives, by their names: of others it gives nothing.
    """

    names: tuple[str, ...]
    odds: float
    next: tuple[str, ...]
    given: frozenset[str]

    @property
    def text(self) -> str:
        """The mistakes, or both explanations where none is much likelier."""
        alone = self.odds >= SURE or NOT_KNOWN in (*self.names, *self.next)
        return ", or ".join(" and ".join(names) for names in (self.names, self.next)[: 1 if alone else 2])

    @property
    def likelier(self) -> str:
        """How much likelier than the next, in words."""
        if self.names == (NOT_KNOWN,):
            return ""
        digits = 0 if self.odds > 10.0 else 1
        times = f"10^{math.log10(self.odds):.0f}" if self.odds > 1e4 else f"{self.odds:.{digits}f}"
        return f"{times} times likelier than {' and '.join(self.next)}"


@dataclass(frozen=True)
class GradedAnswer:
    """One answer and its assessment.

    Attributes:
        question: the wanted quantity.
        given: as it was handed in.
        value: the same in the form's unit; NaN without one.
        expected: what the course's way gives on the student's recordings, in that unit.
        verdict: right, wrong, in a unit of another dimension, not answered, or not judged.
        tolerance: share by which a right answer may be off.
        explained: how the task's answers were made, where that gives this one and it is wrong; None otherwise.
        note: the remark on an answer that is right in one of two ways; empty otherwise.
    """

    question: Question
    given: GivenAnswer | None
    value: float
    expected: float
    verdict: Verdict
    tolerance: float
    explained: Explanation | None = None
    note: str = ""

    @property
    def mistake(self) -> str:
        """What went wrong in the task; empty where nothing did, it is not known, or does not give this answer."""
        return "" if self.explained is None or self.explained.names == (NOT_KNOWN,) else self.explained.text

    @property
    def off(self) -> str:
        """Share by which it is off what is expected; empty where that is not known."""
        if not math.isfinite(self.value) or not self.expected:
            return ""
        ratio = self.value / self.expected
        return f"{ratio - 1.0:+.2%}" if 0.0 < ratio < 2.0 else f"{ratio:.3g} times"

    @property
    def as_given(self) -> str:
        """Value and unit; empty without an answer."""
        return "" if self.given is None else f"{self.given.value:.6g} {self.given.unit or self.question.unit}"

    @property
    def remark(self) -> str:
        """What the student reads with it."""
        if self.explained is not None and self.mistake:
            why = " ".join(WHY[name] for name in self.explained.names if name in WHY)
            return f"{self.mistake}: {why}" if why else self.mistake
        if self.verdict == "wrong unit" and self.given is not None:
            return f"{_measures(self.given.unit)}; give {self.question.unit}, or another unit of the same quantity."
        if self.verdict == "wrong" and not self.note:
            return "Off by more than other right ways would be; no mistake that is known gives this figure."
        return self.note

    def near(self, figures: Figures) -> float:
        """Density of its logarithm, normal about its figure with half the tolerance for a standard deviation."""
        figure, deviation = figures.get(self.question.name, math.nan), 0.5 * self.tolerance
        if not math.isfinite(figure) or self.value * figure <= 0.0:
            return 0.0
        apart = math.log(self.value / figure) / deviation
        return math.exp(-0.5 * min(apart**2, 1400.0)) / (deviation * math.sqrt(2.0 * math.pi))

    @property
    def anywhere(self) -> float:
        """Density of its logarithm where it may be anything."""
        return 0.25 / WIDE * math.exp(-abs(math.log(abs(self.value / self.expected) or 1e-300)) / WIDE)

    def would_be_wrong(self, figures: Figures) -> bool:
        """Whether a way's figure for it is further from what is expected than a right answer may be."""
        figure = figures.get(self.question.name, math.nan)
        known = math.isfinite(figure) and figure != 0.0
        return not known or abs(self.expected / figure - 1.0) / self.tolerance > 1.0


def _measures(unit: str) -> str:
    """What a wrong unit is one of."""
    try:
        return f"'{unit}' measures {dimensionality(unit)}"
    except ValueError:
        return f"'{unit}' is no unit"


def explanation(
    answers: Sequence[GradedAnswer], known: Mapping[str, Any], elsewhere: Collection[str] = ()
) -> Explanation | None:
    """The likeliest of how a task was done, which is done in one way; None where no answer is wrong.

    Args:
        answers: of the task.
        known: of the student's own recordings: `expected`, and `mistakes` with their figures.
        elsewhere: mistakes that the student's other tasks show.
    """
    if all(answer.verdict != "wrong" for answer in answers):
        return None
    expected = known["expected"]
    asked = [answer for answer in answers if math.isfinite(answer.value) and expected.get(answer.question.name)]

    def log_likelihood(figures: Figures, missed: float) -> float:
        densities = ((1.0 - missed) * answer.near(figures) + missed * answer.anywhere for answer in asked)
        return sum(math.log(density + 1e-300) for density in densities)

    weighed: list[tuple[tuple[str, ...], Figures, float]] = []
    weighed.append(((NOT_KNOWN,), expected, math.log(UNKNOWN) + log_likelihood(expected, HALF)))
    for names, prior, figures in _ways(known):
        if any(answer.would_be_wrong(figures) for answer in asked):
            carried = CARRIED if elsewhere and {*names} <= {*elsewhere} else 1.0
            weighed.append((names, figures, math.log(prior * carried) + log_likelihood(figures, SLIPPED)))
    weighed.sort(key=lambda one: -one[2])
    names, figures, best = weighed[0]
    after = next((one for one in weighed[1:] if one[0] != names), weighed[0])
    given = frozenset(answer.question.name for answer in asked if answer.near(figures) > SLIPPED * answer.anywhere)
    return Explanation(names, math.exp(min(best - after[2], 600.0)), after[0], given)


def _ways(known: Mapping[str, Any]) -> Iterator[tuple[tuple[str, ...], float, Figures]]:
    """Names, probability and figures of mistakes in the work, of slips after it, and of two of them."""
    expected, prior = known["expected"], {1: ONE, 2: TWO}
    works = [(tuple(names), {**expected, **changed}) for names, changed in known["mistakes"]]
    for names, figures in (*works, ((), expected)):
        if names:
            yield names, prior[len(names)], figures
        for slip, change in SLIPS.items() if len(names) < 2 else ():
            yield (*names, slip), prior[len(names) + 1], {**figures, **change(figures)}
    for (one, first), (two, second) in combinations(SLIPS.items(), 2):
        figures = {**expected, **first(expected)}
        yield (one, two), TWO, {**figures, **second(figures)}
