"""Which cut-offs of the filter a recording allows, which one suits effects, and which one J, K_w and K_0.

A decade of cut-offs is tried. Effects need a high one: those around a reversal last milliseconds. They are sought at
the highest at which no more than a small share of the acceleration is noise.

J, K_w and K_0 have to be independent of the cut-off. What the model of a rigid axis lacks - a drive that reacts to
noise of its speed, coarse signals, a soft coupling - is mostly at high frequency, and biases the estimate the more of
it the filter passes. So an estimate is accepted only if it agrees with those at all lower cut-offs within their errors
(O. V. Lepski, Theory of Probability and its Applications 35(3), 1991, 454-466). Of the accepted ones the highest is
taken, the most precise on sound recordings, unless another has a clearly narrower interval. If some were rejected, the
interval includes the bias that may remain. A cut-off at which an effect of the model no longer shows is not tried.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import takewhile

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, VISCOUS, AxisKind
from bench.errors import UndeterminedError
from bench.fit.determined import left_open
from bench.fit.fit import Fit, fit
from bench.fit.hum import passes
from bench.fit.hypothesis import plain
from bench.fit.quantities import uncertain
from bench.fit.solution import Solution, solution_of
from bench.rig.rig import Rig
from bench.trace.filter import GaussianFilter

#: Largest share of noise in the acceleration's power at which effects are sought; J is underestimated by that share.
NOISY = 0.1
#: Least number of independent rows: with 25 to 70 an absent effect was named in 5 of 11 recordings, with 90 in 1 of 13.
INDEPENDENT = 100
#: Cut-offs tried below the highest, relative to it: a decade, for J in four steps, for effects in eight.
BELOW, FINER = (10.0 ** -np.linspace(0.0, 1.0, steps + 1)[1:] for steps in (4, 8))
#: Ratio to the interval at the highest accepted cut-off below which another is narrower; 0.70 at least of rigid axes.
NARROWER = 0.6
#: Share of a value by which filters of different widths may differ without any noise.
ROUNDING = 1e-4
#: Terms of the axis, in whose order all numbers here stand.
TERMS = (INERTIA, VISCOUS, COULOMB)
TELLS = "`bench diagnose` searches for the cause"
#: Possible bias of J, K_w and K_0 (3,) as they move with the cut-off, and warnings that they do; of an estimate that
#: stands still.
Moves = tuple[Array, tuple[str, ...]]
STILL: Moves = np.zeros(3), ()


def allowed(highest: Solution, rig: Rig, below: Array, near: bool) -> Iterator[Solution]:
    """Solutions from the highest cut-off down, until the filter is too long for the motion or hides an effect."""
    rows = highest.rows
    yield highest
    for share in below.tolist():
        smooth = GaussianFilter.from_cutoff(rows.conditioning.filter.cutoff * share, rows.scope.sample_period)
        try:
            through = rows.through(smooth, near)
        except UndeterminedError:
            return
        hum = tuple(line for line in highest.hypothesis.hum if passes(line, smooth.width))
        found = replace(highest.hypothesis, step=plain(through).step, hum=hum)
        if found.terms and not _shown(fit(through, found)):
            return
        yield solution_of(through, found, rig.offset)


def for_effects(highest: Solution, rig: Rig) -> Iterator[Solution]:
    """Solutions at cut-offs at which the acceleration is hardly noise, the one that suits effects best first."""
    enough = takewhile(lambda found: found.rows.independent >= INDEPENDENT, allowed(highest, rig, FINER, near=True))
    return (found for found in enough if found.whole.noise_share(INERTIA) <= NOISY)


def for_inertia(highest: Solution, rig: Rig) -> tuple[Solution, Moves]:
    """The solution at the cut-off at which J, K_w and K_0 stand still, and how they move."""
    every = [(found, Tried.of(found, rig.axis_kind)) for found in allowed(highest, rig, BELOW, near=False)]
    usable = [(found, tried) for found, tried in every if np.isfinite(tried.theta[0])]
    if not usable:
        return highest, STILL
    place, moves = among([tried for _, tried in usable], rig.axis_kind)
    return usable[place][0], moves


def _shown(fitted: Fit) -> bool:
    """Whether each effect with strengths has one that differs from zero, however its shape may vary."""
    found = uncertain(fitted)
    errors = found.reach * np.sqrt(np.maximum(np.diag(found.covariance), 0.0))[: fitted.theta.size]
    known = np.abs(fitted.theta) > errors
    return all(np.any(known[own]) for index in range(len(fitted.terms)) if np.any(own := fitted.owners == index))


@dataclass(frozen=True, eq=False)
class Tried:
    """An estimate at one cut-off: J, K_w and K_0, nan where undetermined.

    Attributes:
        cutoff: half-power frequency - Hz.
        theta, by_noise: values, and half widths of their intervals of 95 % as noise alone makes them (3,).
        misfit: half widths from what exceeds the noise (3,); computed only where they may decide, as they take long.
    """

    cutoff: float
    theta: Array
    by_noise: Array
    misfit: Callable[[], Array]

    @classmethod
    def of(cls, found: Solution, kind: AxisKind) -> Tried:
        """The estimate of a solution."""
        unknown = left_open(found.whole, kind)
        places = [found.names.index(term) for term in TERMS]
        known = np.where([term in unknown for term in TERMS], np.nan, 1.0)
        by_noise = found.reach * found.errors[places] * known
        cutoff = found.rows.conditioning.filter.cutoff
        return cls(cutoff, found.theta[places] * known, by_noise, lambda: found.misfit[places])

    @cached_property
    def half_widths(self) -> Array:
        """Of the intervals of 95 % (3,)."""
        return np.hypot(self.by_noise, self.misfit())

    def agrees(self, other: Tried) -> bool:
        """Whether the parameters that both determine agree within their intervals."""
        away = np.abs(self.theta - other.theta) - ROUNDING * np.abs(self.theta)
        if not np.any(away > np.hypot(self.by_noise, other.by_noise)):  # nan: undetermined
            return True
        return not np.any(away > np.hypot(self.half_widths, other.half_widths))


def among(usable: Sequence[Tried], kind: AxisKind) -> tuple[int, Moves]:
    """Place of the chosen of estimates that determine the inertia, from high to low cut-off, and how they move."""
    accepted = [usable[-1]]
    for tried in usable[-2::-1]:
        if not all(tried.agrees(lower) for lower in accepted):
            break
        accepted.append(tried)
    rejected = usable[: len(usable) - len(accepted)]
    if not rejected and all(one.by_noise[0] >= NARROWER * usable[0].half_widths[0] for one in usable[1:]):
        return 0, STILL
    beyond = rejected[-1] if rejected else accepted[-1]
    doubts = [_doubt(tried, beyond, accepted[:k]) for k, tried in enumerate(accepted)]
    wide = [float(np.hypot(tried.half_widths[0], off[0])) for tried, off in zip(accepted, doubts, strict=True)]
    best = int(np.argmin(wide))
    if not rejected and wide[best] >= NARROWER * wide[-1]:
        best = len(accepted) - 1
    warnings = (_moves(accepted[best], usable, kind),) if rejected else ()
    return len(usable) - 1 - best, (doubts[best], warnings)


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
        f"its interval counts what it may still be off; {TELLS}"
    )
