"""The default estimator: least squares of the torque balance without effects, accumulated block by block."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.errors import UndeterminedError
from bench.fit import layout
from bench.fit.covariance import NOISE_ALONE
from bench.fit.cutoffs import TERMS, choose
from bench.fit.determined import left_open, only_direction, require_determined, require_inertia, require_sound
from bench.fit.estimate import Estimate, RefusedEstimateError, Residual
from bench.fit.hypothesis import Hypothesis
from bench.fit.load_inertia import load_inertia
from bench.fit.normal_equations import BLOCKS, NormalEquations, join
from bench.fit.parallel import in_parallel
from bench.fit.parameter import Parameter
from bench.fit.rows import Rows
from bench.fit.solution import SURE, Left, Solved, equations_of, solved_with_shift
from bench.fit.tolerance import by_hint, by_tolerance
from bench.gate.check import Check
from bench.gate.gate import PARTS, gate, joined, passed, require
from bench.rig.rig import Rig
from bench.trace.trace import Trace


@dataclass(frozen=True)
class Gathered:
    """Normal equations of a recording.

    Attributes:
        equations: of every column and, last, a constant.
        rows: of its first part, which determines filter and noise floor.
        hypothesis: without effects.
        effort_unit: N*m, N, or what the rig allows.
        samples_read: of all parts.
        doubt: possible bias of J, K_w and K_0, as they move with the filter's cut-off (3,).
        hinted: by how much an effect that the recording hints at would move them (3,).
        tolerance: half widths of coefficients from the rig's tolerances (p,).
        warnings: about the cut-off.
        checks: of all parts.
    """

    equations: NormalEquations
    rows: Rows
    hypothesis: Hypothesis
    effort_unit: str
    samples_read: int
    doubt: Array
    hinted: Array
    tolerance: Array
    warnings: tuple[str, ...] = ()
    checks: tuple[Check, ...] = ()


def identify(
    trace: Trace | Iterable[Trace] | Sequence[Trace | Iterable[Trace]], rig: Rig, cutoff: float | None = None
) -> Estimate:
    """Inertia, viscous and Coulomb friction (and offset, if the rig asks for it) of a recording, or of several.

    Args:
        trace: the recording; an iterator over its consecutive parts, for one that does not fit into memory; or a list
            (tuple) of several recordings of one axis, which are fitted together (`bench.fit.several`).
        rig: what is known about the axis.
        cutoff: half-power frequency of the filter instead of the one chosen from the data - Hz.

    Raises:
        RefusedEstimateError: the recording leaves one of them undetermined; the error carries the others.
        UndeterminedError: it determines none.
        InputError: a signal is missing, rig and trace do not fit together, or a check of the recording fails.
    """
    if isinstance(trace, Sequence) and len(trace) != 1:
        from bench.fit.several import identify_together  # which imports this module

        return identify_together(trace, rig, cutoff)
    return solve(gather(trace[0] if isinstance(trace, Sequence) else trace, rig, cutoff), rig)


def gather(trace: Trace | Iterable[Trace], rig: Rig, cutoff: float | None) -> Gathered:
    """Normal equations of a recording, or of its consecutive parts; arguments as of `identify`.

    The first part determines the filter of all, and whether they contain mains hum.
    """
    parts = iter([trace] if isinstance(trace, Trace) else trace)
    gated = passed(next(parts), rig)
    first = gated.trace
    chosen = choose(first, rig, cutoff)
    rows, hypothesis = chosen.tried.rows, chosen.tried.hypothesis

    def gathered(part: Trace) -> tuple[NormalEquations, int, tuple[Check, ...]]:
        if part is first:
            return chosen.tried.equations, len(part), gated.checks
        sound = gate(part, rig, PARTS)
        laid = Rows.of(sound.trace, rig, conditioning=rows.conditioning, begins=float(first.time[0]))
        return equations_of(laid, hypothesis), len(sound.trace), sound.checks

    equations, read, checks = zip(*in_parallel(gathered, chain([first], parts)), strict=True)
    together = joined(checks)
    require(together, first)
    unit = rig.net_effort(first)[1]
    whole = join(equations).coarsened(BLOCKS)
    tolerance = by_tolerance(gated.trace, rig, chosen.tried)
    return Gathered(
        whole,
        rows,
        hypothesis,
        unit,
        sum(read),
        chosen.doubt,
        by_hint(chosen.tried),
        tolerance,
        chosen.warnings,
        together,
    )


def solve(gathered: Gathered, rig: Rig) -> Estimate:
    """Estimate from normal equations.

    Raises:
        RefusedEstimateError: they determine only some parameters.
        UndeterminedError: they determine none.
    """
    kind = rig.axis_kind
    require_inertia(gathered.equations, kind)
    one_way = only_direction(gathered.equations) is not None
    found = solved_with_shift(gathered.equations, gathered.rows, rig.offset and not one_way)
    left = Left.of(gathered.rows, gathered.hypothesis, found)
    estimate = _estimate(gathered, rig, found, left)
    try:
        require_determined(gathered.equations, kind)
        require_sound(estimate, kind, (*gathered.warnings, *_remaining(estimate)))
    except UndeterminedError as refusal:
        unknown = {kind.parameter(term) for term in left_open(gathered.equations, kind)}
        determined = {name: value for name, value in estimate.parameters.items() if name not in unknown}
        raise RefusedEstimateError(refusal, replace(estimate, parameters=determined)) from refusal
    return estimate


def _estimate(gathered: Gathered, rig: Rig, found: Solved, left: Left) -> Estimate:
    equations, unit, kind = gathered.equations, gathered.effort_unit, rig.axis_kind
    doubt = np.pad(gathered.doubt, (0, found.theta.size - gathered.doubt.size))
    more = np.sqrt(left.misfit(found) ** 2 + doubt**2 + gathered.tolerance**2)
    parameters = parameters_of(found, kind, unit, more)
    for term, away in zip(TERMS, gathered.hinted, strict=True):
        parameter = parameters[kind.parameter(term)]
        parameters[kind.parameter(term)] = parameter.reaching(parameter.value + float(away))
    parameters |= load_inertia(parameters, rig)
    chosen = equations.select(found.columns)
    power, squares = max(chosen.residual_power(found.theta), 0.0), float(chosen.power.sum())
    if squares == 0.0:
        reason = "the effort is zero throughout"
        raise UndeterminedError(kind.in_words(INERTIA), reason, "the motor's current or torque too")
    mean = float(equations.moment[:, -1].sum()) / equations.count
    smooth = gathered.rows.conditioning.filter
    estimate = Estimate(
        estimator="regression",
        parameters=parameters,
        residual=Residual(math.sqrt(power / chosen.count), left.floor, math.sqrt(power / squares), unit),
        samples_read=gathered.samples_read,
        samples_used=chosen.count * smooth.stride,
        cutoff=smooth.cutoff,
        source=gathered.rows.conditioning.source,
        warnings=(
            *gathered.warnings,
            *_shifted(found.shift, gathered.rows),
            *negative(parameters, kind),
        ),
        explained=1.0 - power / max(squares - equations.count * mean**2, 1e-300),
        checks=gathered.checks,
    )
    return replace(estimate, warnings=(*estimate.warnings, *_remaining(estimate)))


def parameters_of(found: Solved, kind: AxisKind, effort_unit: str, more: Array) -> dict[str, Parameter]:
    """J, K_w, K_0, misalignment and, where it was fitted, offset of a solution, with their intervals.

    Args:
        found: the solution.
        kind: of the axis.
        effort_unit: N*m, N, or what the rig allows.
        more: half widths at 95 % to add to those of the covariance (p,).
    """
    parameters = {}
    for term, place in (TERMS | {MISALIGNMENT: layout.MISALIGNMENT} | ({OFFSET: -1} if found.offset else {})).items():
        value, error, beside = (float(numbers[place]) for numbers in (found.theta, found.errors, more))
        interval = (value - found.reach * error, value + found.reach * error)
        parameter = Parameter(value, kind.parameter_unit(term, effort_unit), error, interval)
        parameters[kind.parameter(term)] = parameter.widened(beside)
    return parameters


def _remaining(estimate: Estimate) -> Iterator[str]:
    """What share is explained, where more than noise is left."""
    residual = estimate.residual
    if residual.rms > NOISE_ALONE * residual.noise_floor:
        yield (
            f"the model explains {estimate.explained:.2%} of the effort's variance and leaves "
            f"{residual.rms / residual.noise_floor:.3g} times what noise alone would: bench diagnose may tell why"
        )


def _shifted(shift: tuple[float, float], rows: Rows) -> Iterator[str]:
    period = rows.scope.sample_period
    if abs(shift[0]) > period and abs(shift[0]) > SURE * shift[1]:
        yield (
            f"current and speed are {shift[0] * 1e3:.3g} ms apart, more than a sample ({period * 1e3:.3g} ms): "
            "a lag in the drive or its filters, which bench diagnose can tell"
        )


def negative(parameters: Mapping[str, Parameter], kind: AxisKind) -> Iterator[str]:
    """A warning of each of J, K_w and K_0 whose interval lies below zero."""
    for term in (INERTIA, VISCOUS, COULOMB):
        name = kind.parameter(term)
        found = parameters[name]
        value = f"{found.value:.3g} {found.unit}"
        if found.ci95[1] < 0.0:
            yield f"{name} is negative ({value}): a sign of current or speed is turned, or the model lacks an effect"
