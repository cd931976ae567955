"""The estimate from one recording alone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.errors import UndeterminedError
from bench.fit.covariance import NOISE_ALONE
from bench.fit.determined import left_open, require_determined, require_inertia, require_sound
from bench.fit.estimate import Estimate, RefusedEstimateError, Residual, load_inertia
from bench.fit.gathered import Gathered
from bench.fit.normal_equations import NormalEquations
from bench.fit.parameter import Parameter
from bench.fit.solution import SURE, Solution
from bench.rig.rig import Rig


def estimated_alone(gathered: Gathered, rig: Rig) -> Estimate:
    """Estimate from the normal equations of a recording.

    Raises:
        RefusedEstimateError: they determine only some parameters.
        UndeterminedError: they determine none.
    """
    kind = rig.axis_kind
    require_inertia(gathered.equations, kind)
    estimate = _estimate(gathered, rig, gathered.solved(rig.offset and gathered.one_way is None))
    return sound(estimate, gathered.equations, kind, (*gathered.warnings, *_remaining(estimate)))


def sound(estimate: Estimate, equations: NormalEquations, kind: AxisKind, suspicions: tuple[str, ...]) -> Estimate:
    """The estimate, if its rows determine it and it means something.

    Args:
        estimate: as found.
        equations: that it is from, of every column, the constant included.
        kind: of the axis.
        suspicions: what may be why if it does not.

    Raises:
        RefusedEstimateError: else, with what is determined.
    """
    try:
        require_determined(equations, kind)
        require_sound(estimate, kind, suspicions)
    except UndeterminedError as refusal:
        unknown = {kind.parameter(term) for term in left_open(equations, kind)}
        determined = {name: value for name, value in estimate.parameters.items() if name not in unknown}
        raise RefusedEstimateError(refusal, replace(estimate, parameters=determined)) from refusal
    return estimate


def _estimate(gathered: Gathered, rig: Rig, found: Solution) -> Estimate:
    equations, unit, kind = gathered.equations, gathered.effort_unit, rig.axis_kind
    parameters = {}
    for term in (INERTIA, VISCOUS, COULOMB, MISALIGNMENT, *([OFFSET] if OFFSET in found.names else [])):
        margins = gathered.doubt.get(term, 0.0), gathered.tolerance.get(term, 0.0)
        parameter = parameter_of(found, term, kind, unit).widened(found.of(term, found.misfit), *margins)
        parameters[kind.parameter(term)] = parameter.reaching(parameter.value + gathered.hinted.get(term, 0.0))
    parameters |= load_inertia(parameters, rig)
    squares = float(found.equations.power.sum())
    if squares == 0.0:
        reason = "the effort is zero throughout"
        raise UndeterminedError(kind.in_words(INERTIA), reason, "the motor's current or torque too")
    mean = float(equations.moment[:, equations.place(OFFSET)].sum()) / equations.count
    rms, relative = math.sqrt(found.power / equations.count), math.sqrt(found.power / squares)
    smooth = gathered.rows.conditioning.filter
    estimate = Estimate(
        estimator="regression",
        parameters=parameters,
        residual=Residual(rms, found.floor.coloured, relative, unit),
        samples_read=gathered.samples_read,
        samples_used=equations.count * smooth.stride,
        cutoff=smooth.cutoff,
        source=gathered.rows.conditioning.source,
        warnings=(*gathered.warnings, *_shifted(found), *negative(parameters, kind)),
        explained=1.0 - found.power / max(squares - equations.count * mean**2, 1e-300),
        checks=gathered.checks,
    )
    return replace(estimate, warnings=(*estimate.warnings, *_remaining(estimate)))


def parameter_of(found: Solution, term: str, kind: AxisKind, effort_unit: str) -> Parameter:
    """A coefficient of a solution with the interval that its covariance gives it.

    Args:
        found: the solution.
        term: of the equation of motion.
        kind: of the axis.
        effort_unit: N*m, N, or what the rig allows.
    """
    value, error = found.of(term, found.theta), found.of(term, found.errors)
    interval = (value - found.reach * error, value + found.reach * error)
    return Parameter(value, kind.parameter_unit(term, effort_unit), error, interval)


def _remaining(estimate: Estimate) -> Iterator[str]:
    """What share is explained, where more than noise is left."""
    residual = estimate.residual
    if residual.rms > NOISE_ALONE * residual.noise_floor:
        yield (
            f"the model explains {estimate.explained:.2%} of the effort's variance and leaves "
            f"{residual.rms / residual.noise_floor:.3g} times what noise alone would: bench diagnose may tell why"
        )


def _shifted(found: Solution) -> Iterator[str]:
    (shift, error), period = found.shift, found.rows.scope.sample_period
    if abs(shift) > period and abs(shift) > SURE * error:
        yield (
            f"current and speed are {shift * 1e3:.3g} ms apart, more than a sample ({period * 1e3:.3g} ms): "
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
