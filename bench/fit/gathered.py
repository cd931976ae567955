"""A recording gathered into normal equations: its first part decides on filter and hum, all parts are summed up.

An estimate has to be independent of the filter's cut-off, so a decade of cut-offs is tried.

What the model of a rigid axis lacks - a drive that reacts to noise of its speed, coarse signals, a soft coupling - is
mostly at high frequency, and biases the estimate the more of it the filter passes. So an estimate is accepted only if
it agrees with those at all lower cut-offs within their errors (O. V. Lepski, Theory of Probability and its Applications
35(3), 1991, 454-466). Of the accepted ones the highest is taken, the most precise on sound recordings, unless another
has a clearly narrower interval. If some were rejected, the interval includes the bias that may remain.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, islice
from typing import TypeVar

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, OFFSET, VISCOUS, AxisKind
from bench.errors import UndeterminedError
from bench.fit.determined import left_open, only_direction
from bench.fit.hum import mains, passes
from bench.fit.hypothesis import Hypothesis
from bench.fit.layout import lay_out, plain
from bench.fit.normal_equations import BLOCKS, Name, NormalEquations, join
from bench.fit.rows import Rows
from bench.fit.solution import Solution, equations_of, solve
from bench.fit.systematic import by_hint, by_tolerance
from bench.gate.check import Check
from bench.gate.gate import PARTS, gate, joined, passed, require
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
TELLS = "bench diagnose may tell why"


@dataclass(frozen=True, eq=False)
class Tried:
    """An estimate at one cut-off: J, K_w and K_0, nan where undetermined.

    Attributes:
        cutoff: half-power frequency - Hz.
        theta, by_noise: values, and half widths of their intervals of 95 % as noise alone makes them (3,).
        misfit: half widths from what stands above the noise (3,); asked only where they may decide, as they take long.
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


@dataclass(frozen=True)
class Chosen:
    """The chosen of several cut-offs, and what the others imply.

    Attributes:
        place: of the chosen one.
        doubt: possible bias of J, K_w and K_0 (3,) as the estimate moves with the cut-off; 0 at the highest.
        warnings: that the estimate moves with the cut-off.
    """

    place: int
    doubt: Array
    warnings: tuple[str, ...] = ()


def choose(first: Trace, rig: Rig, cutoff: float | None) -> tuple[Solution, Chosen]:
    """The solution of a recording, or of its first part, at the chosen cut-off, unless one is given - Hz.

    Raises:
        UndeterminedError: the recording is too short, or never moves clearly.
        InputError: a signal is missing, or rig and recording do not fit together.
    """
    rows = Rows.of(first, rig, cutoff=cutoff)
    highest = solved(rows, plain(rows), rig)
    hum = mains(rows, highest.residual)
    if hum:
        highest = solved(rows, replace(highest.hypothesis, hum=hum), rig)
    return (highest, Chosen(0, np.zeros(3))) if cutoff is not None else steady(highest, rig)


def steady(highest: Solution, rig: Rig) -> tuple[Solution, Chosen]:
    """The solution at the cut-off at which J, K_w and K_0 stand still, of one at the highest and those below it."""
    every = [(found, Tried.of(found, rig.axis_kind)) for found in (highest, *_lower(highest, rig))]
    usable = [(found, tried) for found, tried in every if np.isfinite(tried.theta[0])]
    if not usable:
        return highest, Chosen(0, np.zeros(3))
    chosen = among([tried for _, tried in usable], rig.axis_kind)
    return usable[chosen.place][0], chosen


def _lower(highest: Solution, rig: Rig) -> Iterator[Solution]:
    """Solutions at lower cut-offs, until the filter is too long for the motion."""
    rows = highest.rows
    for share in BELOW:
        smooth = GaussianFilter.from_cutoff(rows.conditioning.filter.cutoff * float(share), rows.scope.sample_period)
        try:
            through = rows.through(smooth)
        except UndeterminedError:
            return
        hum = tuple(line for line in highest.hypothesis.hum if passes(line, smooth.width))
        yield solved(through, replace(highest.hypothesis, step=plain(through).step, hum=hum), rig)


def solved(rows: Rows, hypothesis: Hypothesis, rig: Rig) -> Solution:
    """The solution of a hypothesis, at the cut-off of the rows."""
    laid = lay_out(rows, hypothesis)
    equations = equations_of(rows, laid).coarsened(BLOCKS)
    return solve(rows, hypothesis, laid, equations, rig.offset and only_direction(equations) is None)


def among(usable: Sequence[Tried], kind: AxisKind) -> Chosen:
    """The choice among estimates that determine the inertia, from high to low cut-off."""
    accepted = [usable[-1]]
    for tried in usable[-2::-1]:
        if not all(tried.agrees(lower) for lower in accepted):
            break
        accepted.append(tried)
    rejected = usable[: len(usable) - len(accepted)]
    if not rejected and all(one.by_noise[0] >= NARROWER * usable[0].half_widths[0] for one in usable[1:]):
        return Chosen(0, np.zeros(3))
    beyond = rejected[-1] if rejected else accepted[-1]
    doubts = [_doubt(tried, beyond, accepted[:k]) for k, tried in enumerate(accepted)]
    wide = [float(np.hypot(tried.half_widths[0], off[0])) for tried, off in zip(accepted, doubts, strict=True)]
    best = int(np.argmin(wide))
    if not rejected and wide[best] >= NARROWER * wide[-1]:
        best = len(accepted) - 1
    warnings = (_moves(accepted[best], usable, kind),) if rejected else ()
    return Chosen(len(usable) - 1 - best, doubts[best], warnings)


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


Part = TypeVar("Part")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class Gathered:
    """Normal equations of a recording.

    Attributes:
        first: solution of its first part, at whose filter the others are taken; of all of it where it is one part.
        equations: of every column and, last, a constant.
        effort_unit: N*m, N, or what the rig allows.
        samples_read: of all parts.
        doubt: possible bias of J, K_w and K_0, as they move with the filter's cut-off.
        hinted: by how much an effect that the recording hints at would move them.
        tolerance: half widths of coefficients from the rig's tolerances.
        warnings: about the cut-off.
        checks: of all parts.
        in_parts: whether there are parts beside the first.
    """

    first: Solution
    equations: NormalEquations
    effort_unit: str
    samples_read: int
    doubt: Mapping[str, float]
    hinted: Mapping[str, float]
    tolerance: Mapping[Name, float]
    warnings: tuple[str, ...]
    checks: tuple[Check, ...]
    in_parts: bool

    @property
    def rows(self) -> Rows:
        """Of its first part, which determines filter and noise floor."""
        return self.first.rows

    @cached_property
    def measured(self) -> tuple[float, float]:
        """Sum of the squares of the measured effort over all rows - its unit squared -, and its sum.

        Beside a robot that is what its motor gave, not the small part that its own inertia and friction are to explain.
        """
        equations = self.equations
        if not self.in_parts and self.rows.stretches[0].signals.known:
            effort = self.rows.measured
            return float(effort @ effort), float(effort.sum())
        return float(equations.power.sum()), float(equations.moment[:, equations.place(OFFSET)].sum())

    @cached_property
    def one_way(self) -> str | None:
        """The one direction in which it moves, if it does so."""
        return only_direction(self.equations)

    def solved(self, offset: bool) -> Solution:
        """Its solution with or without a constant, each solved for once."""
        if not self.in_parts and offset == (OFFSET in self.first.names):
            return self.first
        return self._with_offset if offset else self._plain

    @cached_property
    def _plain(self) -> Solution:
        return solve(self.rows, self.first.hypothesis, self.first.laid, self.equations, offset=False)

    @cached_property
    def _with_offset(self) -> Solution:
        return solve(self.rows, self.first.hypothesis, self.first.laid, self.equations, offset=True)


def gather(trace: Trace | Iterable[Trace], rig: Rig, cutoff: float | None) -> Gathered:
    """Normal equations of a recording, or of its consecutive parts, at a cut-off - Hz -, or at the one the data choose.

    Raises:
        UndeterminedError: the recording is too short, or never moves clearly.
        InputError: a signal is missing, rig and recording do not fit together, or a check of the recording fails.
    """
    parts = iter([trace] if isinstance(trace, Trace) else trace)
    gated = passed(next(parts), rig)
    first = gated.trace
    found, chosen = choose(first, rig, cutoff)

    def gathered(part: Trace) -> tuple[NormalEquations, int, tuple[Check, ...]]:
        if part is first:
            return found.whole, len(part), gated.checks
        sound = gate(part, rig, PARTS)
        rows = Rows.of(sound.trace, rig, conditioning=found.rows.conditioning, begins=float(first.time[0]))
        return equations_of(rows, lay_out(rows, found.hypothesis)), len(sound.trace), sound.checks

    equations, read, checks = zip(*in_parallel(gathered, chain([first], parts)), strict=True)
    together = joined(checks)
    require(together, first)
    return Gathered(
        first=found,
        equations=join(equations).coarsened(BLOCKS),
        effort_unit=rig.net_effort(first)[1],
        samples_read=sum(read),
        doubt=dict(zip(TERMS, chosen.doubt.tolist(), strict=True)),
        hinted=by_hint(found),
        tolerance=by_tolerance(first, rig, found, OFFSET in found.names),
        warnings=chosen.warnings,
        checks=together,
        in_parts=len(equations) > 1,
    )


def in_parallel(work: Callable[[Part], Result], parts: Iterable[Part]) -> Iterator[Result]:
    """Results of `work` on each part, in order, on one thread a core; NumPy releases the interpreter lock.

    At most two parts a core are in memory, so a recording may be larger than it. A single part is done without threads,
    whose start takes milliseconds.
    """
    cores, parts = os.cpu_count() or 1, iter(parts)
    ahead = list(islice(parts, 2))
    if len(ahead) < 2:
        yield from map(work, ahead)
        return
    waiting: deque[Future[Result]] = deque()
    with ThreadPoolExecutor(cores) as pool:
        for part in chain(ahead, parts):
            waiting.append(pool.submit(work, part))
            if len(waiting) >= 2 * cores:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
