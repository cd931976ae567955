"""The default estimator: least squares on consistently filtered columns, with honest intervals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import chain

import numpy as np
from scipy import special

from bench.identify.covariance import long_run_covariance
from bench.identify.determined import require_determined, require_significant
from bench.identify.estimate import Estimate, Parameter, Residual
from bench.identify.load_inertia import load_inertia
from bench.identify.normal_equations import NormalEquations, join, normal_equations
from bench.identify.parallel import in_parallel
from bench.identify.regressors import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, regressors
from bench.rig.rig import Rig
from bench.trace.conditioning import Conditioning, condition
from bench.trace.motion import motion
from bench.trace.trace import Trace

#: Blocks of time in filter widths: neighbouring blocks then share little beside the residual's own correlation.
BLOCK_WIDTHS = 8.0
#: Blocks that the covariance needs at most, of a recording and of each of its parts.
BLOCKS = 512


def identify(trace: Trace | Iterable[Trace], rig: Rig, cutoff: float | None = None) -> Estimate:
    """Inertia, viscous and Coulomb friction (and offset, if the rig asks for it) of a recording.

    Args:
        trace: the recording, or its consecutive parts for one that does not fit into memory; the first part decides
            how all are filtered.
        rig: what is known about the axis.
        cutoff: half-power frequency of the filter instead of the one chosen from the data - Hz.

    Raises:
        UndeterminedError: the recording does not determine one of them.
        InputError: a signal is missing, or rig and trace do not fit together.
    """
    parts = iter([trace] if isinstance(trace, Trace) else trace)
    first = next(parts)
    effort, effort_unit = rig.net_effort(first)
    conditioning = condition(first, effort, cutoff)

    def gathered(part: Trace) -> tuple[NormalEquations, int]:
        columns = regressors(motion(part, rig.net_effort(part)[0], conditioning))
        return normal_equations(columns, BLOCK_WIDTHS * conditioning.filter.width, BLOCKS), len(part)

    equations, read = zip(*in_parallel(gathered, chain([first], parts)), strict=True)
    return solve(join(equations).coarsened(BLOCKS), rig, conditioning, effort_unit, sum(read))


def solve(
    equations: NormalEquations, rig: Rig, conditioning: Conditioning, effort_unit: str, samples_read: int
) -> Estimate:
    """Estimate from normal equations, refusing what they do not determine.

    Intervals come from the residuals' own correlation, never narrower than the effort's white noise alone makes them,
    with Student's t at as many degrees of freedom as there are independent stretches.
    """
    kind = rig.axis_kind
    require_determined(equations, kind)
    columns = [INERTIA, VISCOUS, COULOMB, *([OFFSET] if rig.offset else []), MISALIGNMENT]
    chosen = equations.select(columns)
    inverse = np.linalg.inv(chosen.matrix)
    theta = inverse @ chosen.moment.sum(axis=0)
    middle, bandwidth = long_run_covariance(chosen.scores(theta))
    independent = chosen.rows.size / bandwidth
    degrees = max(independent - len(columns), 1.0)
    correlated = np.diag(inverse @ middle @ inverse) * independent / degrees
    least = conditioning.effort_noise**2 / conditioning.filter.stride * np.diag(inverse)
    std_error = np.sqrt(np.maximum(correlated, least))
    reach = special.stdtrit(degrees, 0.975) * std_error  # Student's t without scipy.stats, which takes 0.3 s to import
    parameters = {
        kind.parameter(column): Parameter(
            float(value),
            kind.parameter_unit(column, effort_unit),
            float(error),
            (float(value - r), float(value + r)),
        )
        for column, value, error, r in zip(columns, theta, std_error, reach, strict=True)
    }
    require_significant(parameters[kind.parameter(INERTIA)], kind)
    parameters |= load_inertia(parameters, rig)
    power = max(chosen.residual_power(theta), 0.0)
    residual = Residual(
        rms=math.sqrt(power / chosen.count),
        noise_floor=_noise_floor(dict(zip(columns, theta, strict=True)), conditioning),
        relative=math.sqrt(power / chosen.power.sum()),
        unit=effort_unit,
    )
    return Estimate(
        estimator="regression",
        parameters=parameters,
        residual=residual,
        samples_read=samples_read,
        samples_used=chosen.count * conditioning.filter.stride,
        cutoff=conditioning.filter.cutoff,
        source=conditioning.source,
        warnings=tuple(_warnings(parameters, rig, conditioning)),
    )


def _noise_floor(theta: dict[str, float], conditioning: Conditioning) -> float:
    """What white sensor noise leaves in the residual: effort noise, and speed noise through J and K_w."""
    return math.sqrt(
        (conditioning.effort_noise * conditioning.filter.noise_gain(0)) ** 2
        + (theta[INERTIA] * conditioning.acceleration_noise) ** 2
        + (theta[VISCOUS] * conditioning.velocity_noise) ** 2
        + (theta[MISALIGNMENT] * conditioning.effort_noise * conditioning.filter.noise_gain(1)) ** 2
    )


def _warnings(parameters: dict[str, Parameter], rig: Rig, conditioning: Conditioning) -> Iterator[str]:
    shift, period = parameters["misalignment"], conditioning.filter.sample_period
    if abs(shift.value) > period and abs(shift.value) > 3.0 * shift.std_error:
        yield (
            f"current and speed are {shift.value * 1e3:.3g} ms apart, more than a sample ({period * 1e3:.3g} ms): "
            "a lag in the drive or its filters, which bench diagnose can tell"
        )
    for column in (INERTIA, VISCOUS, COULOMB):
        name = rig.axis_kind.parameter(column)
        found = parameters[name]
        if found.ci95[1] < 0.0:
            value = f"{found.value:.3g} {found.unit}"
            yield f"{name} is negative ({value}): a sign of current or speed is turned, or the model lacks an effect"
