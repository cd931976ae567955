"""What a student's answers of a task tell of how they were made, and how much likelier that is than the next.

Each explanation has figures of its own for the answers; an answer lies about its figure as right ones do about theirs,
or, seldom, anywhere. Where none does, each answer is right or anything: "not known".
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from bench.course.answers import SLIPS

#: Probability that a task was done with one mistake, and with two; copied, of any neighbour; and in a way not known.
ONE, TWO, COPIED, UNKNOWN = 1e-2, 1e-4, 1e-3, 1e-3
#: Probability of an answer that an explanation does not reach; of one that is right where nothing is known.
SLIPPED, HALF = 1e-3, 0.5
#: Any answer: width of the spread of its logarithm about what is expected.
WIDE = 1.5
#: An explanation so many times likelier than the next is named alone.
SURE = 20.0
#: A mistake made in another task, by one and the same function, is so many times likelier made in this one too.
CARRIED = 50.0
NOT_KNOWN, COPY = "not known", "copied from student "

#: What a way of working gives, by the names of the form.
Figures = Mapping[str, float]


@dataclass(frozen=True)
class Explanation:
    """How answers of a task were made.

    Attributes:
        names: of the mistakes, two where both were made; one of NOT_KNOWN, or that they were copied.
        odds: against the next explanation.
        next: its names.
        given: answers that it gives, by their names: of others it says nothing.
    """

    names: tuple[str, ...]
    odds: float
    next: tuple[str, ...]
    given: frozenset[str]

    @property
    def text(self) -> str:
        """The mistakes, or both explanations where none is much likelier."""
        own = " and ".join(self.names)
        return (
            own
            if self.odds >= SURE or NOT_KNOWN in (*self.names, *self.next)
            else f"{own}, or {' and '.join(self.next)}"
        )

    @property
    def likelier(self) -> str:
        """How much likelier than the next, in words."""
        if self.names == (NOT_KNOWN,):
            return ""
        times = (
            f"10^{math.log10(self.odds):.0f}" if self.odds > 1e4 else f"{self.odds:.{0 if self.odds > 10.0 else 1}f}"
        )
        return f"{times} times likelier than {' and '.join(self.next)}"


def explanation(
    answers: Figures,
    tolerances: Mapping[str, float],
    of_student: Mapping[str, Any],
    others: Mapping[str, Figures],
    elsewhere: Collection[str] = (),
) -> Explanation:
    """The likeliest of how answers were made that are not all right.

    Args:
        answers: of a task, in the form's units.
        tolerances: share by which a right answer may be off, of each.
        of_student: what the truth of a class has of the student: `expected`, and `mistakes` with their figures.
        others: what is expected of each other student.
        elsewhere: mistakes that the student's other tasks tell.
    """
    expected = of_student["expected"]
    asked = {name: value for name, value in answers.items() if expected.get(name)}
    anything = (_log_density(asked[name], name, expected, expected, tolerances, HALF) for name in asked)
    weighed = [((NOT_KNOWN,), expected, math.log(UNKNOWN) + sum(anything))]
    ways = [
        *_singles_and_pairs(of_student),
        *(((COPY + name,), COPIED / len(others), own) for name, own in others.items()),
    ]
    for names, prior, figures in ways:
        if any(_apart(expected, figures, name, tolerances) > 1.0 for name in asked):
            likely = sum(
                _log_density(value, name, figures, expected, tolerances, SLIPPED) for name, value in asked.items()
            )
            carried = CARRIED if elsewhere and {*names} <= {*elsewhere} else 1.0
            weighed.append((names, figures, math.log(prior * carried) + likely))
    weighed.sort(key=lambda one: -one[2])
    names, figures, best = weighed[0]
    after = next((one for one in weighed[1:] if one[0] != names), weighed[0])
    given = frozenset(
        name
        for name, value in asked.items()
        if _near(value, name, figures, tolerances) > SLIPPED * _wide(value, name, expected)
    )
    return Explanation(names, math.exp(min(best - after[2], 600.0)), after[0], given)


def _singles_and_pairs(of_student: Mapping[str, Any]) -> Iterator[tuple[tuple[str, ...], float, Figures]]:
    """Names, probability and figures of mistakes in the work, of slips after it, and of two of them."""
    expected = of_student["expected"]
    for names, changed in of_student["mistakes"]:
        figures = {**expected, **changed}
        yield tuple(names), ONE if len(names) == 1 else TWO, figures
        if len(names) == 1:
            for slip, _, change in SLIPS:
                yield (*names, slip), TWO, {**figures, **change(figures)}
    for slip, _, change in SLIPS:
        yield (slip,), ONE, {**expected, **change(expected)}
    for (one, _, first), (two, _, second) in combinations(SLIPS, 2):
        figures = {**expected, **first(expected)}
        yield (one, two), TWO, {**figures, **second(figures)}


def _apart(answers: Figures, figures: Figures, name: str, tolerances: Mapping[str, float]) -> float:
    """Distance from a figure in shares of what is allowed."""
    figure = figures.get(name, math.nan)
    if not math.isfinite(figure) or figure == 0.0:
        return math.inf
    return abs(answers[name] / figure - 1.0) / tolerances[name]


def _log_density(
    value: float, name: str, figures: Figures, expected: Figures, tolerances: Mapping[str, float], missed: float
) -> float:
    """Of an answer's logarithm: about its figure, or anywhere."""
    near = _near(value, name, figures, tolerances)
    return math.log((1.0 - missed) * near + missed * _wide(value, name, expected) + 1e-300)


def _near(value: float, name: str, figures: Figures, tolerances: Mapping[str, float]) -> float:
    """Density of a logarithm that is normal about its figure, twice its deviation being what is allowed."""
    figure, deviation = figures.get(name, math.nan), 0.5 * tolerances[name]
    if not math.isfinite(figure) or value * figure <= 0.0:
        return 0.0
    apart = math.log(value / figure) / deviation
    return math.exp(-0.5 * min(apart**2, 1400.0)) / (deviation * math.sqrt(2.0 * math.pi))


def _wide(value: float, name: str, expected: Figures) -> float:
    """Density of a logarithm that may be anything."""
    return 0.25 / WIDE * math.exp(-abs(math.log(abs(value / expected[name]) or 1e-300)) / WIDE)
