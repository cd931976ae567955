"""Least squares of normal equations with honest errors: correlated residuals, a shift of the torque, misfit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, VISCOUS
from bench.fit import layout
from bench.fit.covariance import estimated, misfit
from bench.fit.determined import INDEPENDENT_SHARE, independent_share
from bench.fit.hypothesis import Hypothesis
from bench.fit.last_digit import cut_beforehand, plain, rounding
from bench.fit.layout import Layout, lay_out
from bench.fit.noise import noise_floor, noise_power
from bench.fit.normal_equations import NormalEquations, normal_equations, solved
from bench.fit.rows import Rows

#: Standard errors by which a shift of torque against speed must exceed a tick to be one: below, it is held at a tick.
SURE = 3.0


def equations_of(rows: Rows, hypothesis: Hypothesis) -> NormalEquations:
    """Normal equations of a hypothesis' columns and, behind them, a constant."""
    laid = lay_out(rows, hypothesis)
    columns = np.column_stack([laid.columns, np.ones(laid.effort.size)])
    return normal_equations(columns, laid.effort, rows.time, np.pad(laid.noise, (0, 1)), rows.conditioning.filter.width)


@dataclass(frozen=True)
class Solved:
    """Coefficients of chosen columns with their covariance, and how far an interval of 95 % reaches.

    Attributes:
        columns: places of the chosen ones.
        offset: whether the last of them is the constant.
        theta: (p,).
        covariance: (p, p).
        reach: in standard errors.
        shift: by which the least residual wants torque behind speed, and its standard error - s.
        held: whether the shift is held at a tick.
    """

    columns: list[int]
    offset: bool
    theta: Array
    covariance: Array
    reach: float
    shift: tuple[float, float]
    held: bool = False

    @property
    def errors(self) -> Array:
        """Standard errors (p,)."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def solved_with_shift(equations: NormalEquations, rows: Rows, offset: bool) -> Solved:
    """Least squares; the shift of torque against speed is limited to a tick unless a larger one is significant.

    A drive latches its signals within one tick. Along a sine, shift and viscous friction are inseparable: noise that
    the drive feeds back gave a false shift of 4 ms and 26 times the friction.
    """
    width = equations.noise.shape[0]
    columns = list(range(width if offset else width - 1))
    measured = equations.select(columns)
    chosen, beforehand = with_digit(measured, rows)
    theta, inverse = chosen.solve()
    least = rows.conditioning.effort_noise**2 / rows.conditioning.filter.stride
    unknown = inverse @ beforehand @ inverse
    covariance, reach = estimated(measured.scores(theta), inverse, least)
    covariance = covariance + unknown
    at = layout.MISALIGNMENT
    shift = float(theta[at]), float(np.sqrt(max(covariance[at, at], 0.0)))
    bound = rows.scope.latched
    sure = abs(shift[0]) > bound + SURE * shift[1]
    apart = independent_share(equations, MISALIGNMENT, (INERTIA, VISCOUS, COULOMB)) >= INDEPENDENT_SHARE
    hold = abs(shift[0]) > bound and not (sure and apart)
    if hold:
        kept = [k for k in range(theta.size) if k != at]
        held = float(np.copysign(bound, theta[at]))
        gram, moment = chosen.gram.sum(axis=0), chosen.moment.sum(axis=0) - held * chosen.gram.sum(axis=0)[:, at]
        rest, _ = solved(gram[np.ix_(kept, kept)], moment[kept], chosen.count * chosen.noise[np.ix_(kept, kept)])
        theta = np.insert(rest, at, held)
        covariance, reach = estimated(measured.scores(theta), inverse, least)
        covariance = covariance + unknown
    return Solved(columns, offset, theta, covariance, reach, shift if apart else (0.0, shift[1]), hold)


def with_digit(equations: NormalEquations, rows: Rows) -> tuple[NormalEquations, Array]:
    """The equations with a prior of the effort's last digit, if that is a column; and the variance it adds (p, p).

    Where torque and speed change sign together, truncation of the current and dry friction are inseparable. Truncation
    is at most half a step, and the interval of friction includes that range; fitted freely, it took half of it.
    """
    beforehand, step = np.zeros_like(equations.noise), plain(rows).step
    if not step:
        return equations, beforehand
    value, variance = cut_beforehand(step)
    power = max(equations.residual_power(equations.solve()[0]), 0.0) / equations.count
    weight = power / variance
    beforehand[layout.CUT, layout.CUT] = weight**2 * variance
    return equations.knowing(layout.CUT, value, weight), beforehand


@dataclass(frozen=True)
class Left:
    """Residual of a solution over a recording's first part.

    Attributes:
        laid: its columns.
        residual: (m,) - the effort's unit.
        floor: expected RMS from sensor noise - the effort's unit.
    """

    laid: Layout
    residual: Array
    floor: float

    @classmethod
    def of(cls, rows: Rows, hypothesis: Hypothesis, found: Solved) -> Left:
        """Residual and noise floor of a solution."""
        laid = lay_out(rows, hypothesis)
        theta = found.theta[: laid.owners.size]
        offset = float(found.theta[-1]) if found.theta.size > laid.owners.size else 0.0
        modelled = laid.columns @ theta + offset
        residual, cut = laid.effort - modelled, float(theta[laid.owners == layout.DIGIT].sum())
        rounded = rounding(rows, hypothesis.step, modelled, cut)
        floor = noise_floor(rows, noise_power(rows, hypothesis, laid, theta), residual, rounded).coloured
        return cls(laid, residual, floor)

    def misfit(self, found: Solved) -> Array:
        """Half widths at 95 % from the residual above noise (p,); 0 if there is none."""
        columns = self.laid.columns
        if found.offset:
            columns = np.column_stack([columns, np.ones(self.residual.size)])
        free = [k for k in range(found.theta.size) if not (found.held and k == layout.MISALIGNMENT)]
        reaches = np.zeros(found.theta.size)
        reaches[free] = misfit(columns[:, free], self.residual, self.floor)
        return reaches
