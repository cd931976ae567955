"""The default estimator: the fit of the empty hypothesis, gathered block by block, with honest intervals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np

from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS
from bench.balance import layout
from bench.balance.covariance import estimated
from bench.balance.fit import fit
from bench.balance.hum import with_hum
from bench.balance.hypothesis import Hypothesis
from bench.balance.layout import lay_out
from bench.balance.noise import noise_floor, white_power
from bench.balance.normal_equations import BLOCKS, NormalEquations, join, normal_equations, solved
from bench.balance.parameter import Parameter
from bench.balance.rows import Rows
from bench.identify.determined import PLACES, require_determined, require_significant
from bench.identify.estimate import Estimate, Residual
from bench.identify.load_inertia import load_inertia
from bench.identify.parallel import in_parallel
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Standard errors by which a shift of torque against speed must exceed a tick to be one: below, it is held at a tick.
SURE = 3.0


def identify(trace: Trace | Iterable[Trace], rig: Rig, cutoff: float | None = None) -> Estimate:
    """Inertia, viscous and Coulomb friction (and offset, if the rig asks for it) of a recording.

    Args:
        trace: the recording, or its consecutive parts for one that does not fit into memory; the first part decides
            how all are filtered, and whether the mains hum in them.
        rig: what is known about the axis.
        cutoff: half-power frequency of the filter instead of the one chosen from the data - Hz.

    Raises:
        UndeterminedError: the recording does not determine one of them.
        InputError: a signal is missing, or rig and trace do not fit together.
    """
    parts = iter([trace] if isinstance(trace, Trace) else trace)
    first = next(parts)
    rows = Rows.of(first, rig, cutoff=cutoff)
    hypothesis = with_hum(fit(rows, Hypothesis())).hypothesis

    def gathered(part: Trace) -> tuple[NormalEquations, int]:
        same = part is first
        laid = rows if same else Rows.of(part, rig, conditioning=rows.conditioning, begins=float(first.time[0]))
        return equations_of(laid, hypothesis), len(part)

    equations, read = zip(*in_parallel(gathered, chain([first], parts)), strict=True)
    return solve(join(equations).coarsened(BLOCKS), rig, rows, hypothesis, rig.net_effort(first)[1], sum(read))


def equations_of(rows: Rows, hypothesis: Hypothesis) -> NormalEquations:
    """Normal equations of a hypothesis' columns and, behind them, a constant."""
    laid = lay_out(rows, hypothesis)
    columns = np.column_stack([laid.columns, np.ones(laid.effort.size)])
    return normal_equations(columns, laid.effort, rows.time, np.pad(laid.noise, (0, 1)), rows.conditioning.filter.width)


@dataclass(frozen=True)
class Solved:
    """Coefficients of chosen columns with standard errors, and how far an interval of 95 % reaches in them.

    Attributes:
        columns: places of the chosen ones.
        theta, errors: (p,).
        reach: in standard errors.
        shift: by which the least residual wants torque behind speed, and its standard error - s.
    """

    columns: list[int]
    theta: np.ndarray
    errors: np.ndarray
    reach: float
    shift: tuple[float, float]


def solve(
    equations: NormalEquations, rig: Rig, rows: Rows, hypothesis: Hypothesis, effort_unit: str, samples_read: int
) -> Estimate:
    """Estimate from normal equations, refusing what they do not determine.

    Args:
        equations: of all parts.
        rig: of the axis.
        rows: of the first part, from which the noise floor is read.
        hypothesis: without effects.
        effort_unit: N*m, N, or what the rig allows.
        samples_read: of all parts.
    """
    kind = rig.axis_kind
    require_determined(equations, kind)
    found = _solved(equations, rows, rig.offset)
    chosen = equations.select(found.columns)
    terms = [INERTIA, VISCOUS, COULOMB, MISALIGNMENT, *([OFFSET] if rig.offset else [])]
    places = [found.columns.index(PLACES[term] % equations.noise.shape[0]) for term in terms]
    parameters = {}
    for term, place in zip(terms, places, strict=True):
        value, error = float(found.theta[place]), float(found.errors[place])
        interval = (value - found.reach * error, value + found.reach * error)
        parameters[kind.parameter(term)] = Parameter(value, kind.parameter_unit(term, effort_unit), error, interval)
    require_significant(parameters[kind.parameter(INERTIA)], kind)
    parameters |= load_inertia(parameters, rig)
    power = max(chosen.residual_power(found.theta), 0.0)
    residual = Residual(
        rms=math.sqrt(power / chosen.count),
        noise_floor=_floor(rows, hypothesis, found),
        relative=math.sqrt(power / chosen.power.sum()),
        unit=effort_unit,
    )
    smooth = rows.conditioning.filter
    return Estimate(
        estimator="regression",
        parameters=parameters,
        residual=residual,
        samples_read=samples_read,
        samples_used=chosen.count * smooth.stride,
        cutoff=smooth.cutoff,
        source=rows.conditioning.source,
        warnings=tuple(_warnings(parameters, found.shift, rig, rows)),
    )


def _solved(equations: NormalEquations, rows: Rows, offset: bool) -> Solved:
    """Least squares; a shift of torque against speed beyond a tick is one only if it is sure, else held at the tick."""
    width = equations.noise.shape[0]
    columns = list(range(width if offset else width - 1))
    chosen = equations.select(columns)
    theta, inverse = chosen.solve()
    least = rows.conditioning.effort_noise**2 / rows.conditioning.filter.stride
    covariance, reach = estimated(chosen.scores(theta), inverse, least)
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    at = layout.MISALIGNMENT
    shift = float(theta[at]), float(errors[at])
    bound = rows.scope.latched
    if bound < abs(shift[0]) <= bound + SURE * shift[1]:
        kept = [k for k in range(theta.size) if k != at]
        held = float(np.copysign(bound, theta[at]))
        gram, moment = chosen.gram.sum(axis=0), chosen.moment.sum(axis=0) - held * chosen.gram.sum(axis=0)[:, at]
        rest, _ = solved(gram[np.ix_(kept, kept)], moment[kept], chosen.count * chosen.noise[np.ix_(kept, kept)])
        theta = np.insert(rest, at, held)
        covariance, reach = estimated(chosen.scores(theta), inverse, least)
        errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return Solved(columns, theta, errors, reach, shift)


def _floor(rows: Rows, hypothesis: Hypothesis, found: Solved) -> float:
    """What the sensors' noise leaves in the residual of the first part."""
    laid = lay_out(rows, hypothesis)
    theta = found.theta[: laid.owners.size]
    offset = float(found.theta[-1]) if found.theta.size > laid.owners.size else 0.0
    left = laid.effort - laid.columns @ theta - offset
    return noise_floor(rows, white_power(rows, hypothesis, laid, theta), left).coloured


def _warnings(parameters: dict[str, Parameter], shift: tuple[float, float], rig: Rig, rows: Rows) -> Iterator[str]:
    period = rows.scope.sample_period
    if abs(shift[0]) > period and abs(shift[0]) > SURE * shift[1]:
        yield (
            f"current and speed are {shift[0] * 1e3:.3g} ms apart, more than a sample ({period * 1e3:.3g} ms): "
            "a lag in the drive or its filters, which bench diagnose can tell"
        )
    for term in (INERTIA, VISCOUS, COULOMB):
        name = rig.axis_kind.parameter(term)
        found = parameters[name]
        if found.ci95[1] < 0.0:
            value = f"{found.value:.3g} {found.unit}"
            yield f"{name} is negative ({value}): a sign of current or speed is turned, or the model lacks an effect"
