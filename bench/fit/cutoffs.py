"""Choice of the filter's cut-off: an estimate has to be independent of it, so a decade of cut-offs is tried.

What the model of a rigid axis lacks - a drive that reacts to noise of its speed, coarse signals, a soft coupling - is
mostly at high frequency, and biases the estimate the more of it the filter passes. So an estimate is accepted only if
it agrees with those at all lower cut-offs within their errors (O. V. Lepski, Theory of Probability and its Applications
35(3), 1991, 454-466). Of the accepted ones the highest is taken, the most precise on sound recordings, unless another
has a clearly narrower interval. If some were rejected, the interval includes the bias that may remain.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, VISCOUS, AxisKind
from bench.errors import UndeterminedError
from bench.fit.determined import left_open, only_direction
from bench.fit.hum import mains
from bench.fit.hypothesis import Hypothesis
from bench.fit.last_digit import plain
from bench.fit.layout import lay_out
from bench.fit.normal_equations import BLOCKS, NormalEquations
from bench.fit.rows import Rows
from bench.fit.solution import Solution, equations_of, solve
from bench.rig.rig import Rig
from bench.trace.filter import GaussianFilter
from bench.trace.trace import Trace

#: Cut-offs tried below the highest, relative to it: a decade in four steps.
BELOW = 10.0 ** -np.arange(0.25, 1.01, 0.25)
#: Ratio to the interval at the highest accepted cut-off below which another interval counts as narrower; on 100
#: recordings of rigid axes the smallest ratio was 0.70.
NARROWER = 0.6
#: Share of a value by which filters of different widths may differ without any noise.
ROUNDING = 1e-4
#: Terms of the axis, in whose order all numbers here stand.
TERMS = (INERTIA, VISCOUS, COULOMB)


@dataclass(frozen=True, eq=False)
class Tried:
    """An estimate at one cut-off.

    Attributes:
        cutoff: half-power frequency - Hz.
        theta, half_widths: J, K_w and K_0 with half widths of their intervals of 95 % (3,); nan if undetermined.
    """

    cutoff: float
    theta: Array
    half_widths: Array

    @property
    def determines_inertia(self) -> bool:
        """Whether it determines the inertia."""
        return bool(np.isfinite(self.half_widths[0]))

    def agrees(self, other: Tried) -> bool:
        """Whether the parameters that both determine agree within their intervals."""
        away = np.abs(self.theta - other.theta) - ROUNDING * np.abs(self.theta)
        return not bool(np.any(away > np.hypot(self.half_widths, other.half_widths)))  # nan: undetermined


@dataclass(frozen=True, eq=False)
class Solved(Tried):
    """An estimate at one cut-off, and how it came about.

    Attributes:
        equations: of the recording's first part, every column and a constant.
        solution: of these.
    """

    equations: NormalEquations
    solution: Solution

    @classmethod
    def of(cls, rows: Rows, rig: Rig) -> Solved:
        """The estimate of these rows, the hum of the mains that they show taken out."""
        found, equations = _solved(rows, plain(rows), rig)
        hum = mains(rows, found.residual)
        if hum:
            found, equations = _solved(rows, replace(found.hypothesis, hum=hum), rig)
        unknown = left_open(equations, rig.axis_kind)
        theta, half_widths = np.full(3, np.nan), np.full(3, np.nan)
        for place, term in enumerate(TERMS):
            if term not in unknown:
                theta[place] = found.of(term, found.theta)
                half_widths[place] = np.hypot(found.reach * found.of(term, found.errors), found.of(term, found.misfit))
        return cls(rows.conditioning.filter.cutoff, theta, half_widths, equations, found)


def _solved(rows: Rows, hypothesis: Hypothesis, rig: Rig) -> tuple[Solution, NormalEquations]:
    laid = lay_out(rows, hypothesis)
    equations = equations_of(rows, laid).coarsened(BLOCKS)
    return solve(rows, hypothesis, laid, equations, rig.offset and only_direction(equations) is None), equations


#: An estimate with or without how it came about.
Estimated = TypeVar("Estimated", bound=Tried)


@dataclass(frozen=True)
class Chosen(Generic[Estimated]):
    """The chosen cut-off, and what the others imply.

    Attributes:
        tried: the estimate there, of the recording's first part.
        doubt: possible bias of J, K_w and K_0 (3,) as the estimate moves with the cut-off; 0 at the highest.
        warnings: that the estimate moves with the cut-off.
    """

    tried: Estimated
    doubt: Array
    warnings: tuple[str, ...] = ()


def choose(first: Trace, rig: Rig, cutoff: float | None) -> Chosen[Solved]:
    """Choose the cut-off, unless one is given.

    Args:
        first: the recording, or its first part.
        rig: of the axis.
        cutoff: half-power frequency to take - Hz.

    Raises:
        UndeterminedError: the recording is too short, or never moves clearly.
        InputError: a signal is missing, or rig and recording do not fit together.
    """
    highest = Solved.of(Rows.of(first, rig, cutoff=cutoff), rig)
    if cutoff is not None:
        return Chosen(highest, np.zeros(3))
    usable = [tried for tried in (highest, *_lower(highest, rig)) if tried.determines_inertia]
    return among(usable, rig.axis_kind) if usable else Chosen(highest, np.zeros(3))


def _lower(highest: Solved, rig: Rig) -> Iterator[Solved]:
    """Estimates at lower cut-offs, until the filter is too long for the motion."""
    rows = highest.solution.rows
    for share in BELOW:
        smooth = GaussianFilter.from_cutoff(highest.cutoff * float(share), rows.scope.sample_period)
        try:
            yield Solved.of(rows.through(smooth), rig)
        except UndeterminedError:
            return


def among(usable: Sequence[Estimated], kind: AxisKind) -> Chosen[Estimated]:
    """The choice among estimates.

    Args:
        usable: that determine the inertia, from high to low cut-off.
        kind: of the axis.
    """
    accepted = [usable[-1]]
    for tried in usable[-2::-1]:
        if not all(tried.agrees(lower) for lower in accepted):
            break
        accepted.append(tried)
    rejected = usable[: len(usable) - len(accepted)]
    beyond = rejected[-1] if rejected else accepted[-1]
    doubts = [_doubt(tried, beyond, accepted[:k]) for k, tried in enumerate(accepted)]
    wide = [float(np.hypot(tried.half_widths[0], off[0])) for tried, off in zip(accepted, doubts, strict=True)]
    best = int(np.argmin(wide))
    if not rejected and wide[best] >= NARROWER * wide[-1]:
        best = len(accepted) - 1
    warnings = (_moves(accepted[best], usable, kind),) if rejected else ()
    return Chosen(accepted[best], doubts[best], warnings)


def _doubt(taken: Tried, beyond: Tried, lower: Sequence[Tried]) -> Array:
    """Possible bias of J, K_w and K_0 (3,): at most what they moved, and what lower cut-offs allow."""
    moved = np.abs(beyond.theta - taken.theta)
    room = [np.abs(other.theta - taken.theta) + other.half_widths for other in lower]
    return np.nan_to_num(np.fmin.reduce([moved, *room]))


def _moves(taken: Tried, usable: Sequence[Tried], kind: AxisKind) -> str:
    """That a quantity moves with the cut-off, and how."""
    away = [np.abs(tried.theta - taken.theta) / np.hypot(tried.half_widths, taken.half_widths) for tried in usable]
    term = int(np.argmax(np.nan_to_num(away).max(axis=0)))
    course = ", ".join(f"{tried.theta[term]:.4g} at {tried.cutoff:.3g} Hz" for tried in usable)
    return (
        f"{kind.parameter(TERMS[term])} moves with the filter's cut-off ({course}): taken at {taken.cutoff:.3g} Hz, "
        "its interval counts what it may still be off; bench diagnose may tell why"
    )
