"""Least squares of a recording's normal equations with honest errors: correlated residuals, a shift, misfit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS
from bench.fit.covariance import NOISE_ALONE, estimated, misfit
from bench.fit.determined import INDEPENDENT_SHARE
from bench.fit.hypothesis import Hypothesis
from bench.fit.layout import DIGIT, Layout, cut_beforehand, rounding
from bench.fit.noise import Floor, noise_power
from bench.fit.normal_equations import Name, NormalEquations, normal_equations
from bench.fit.rows import Rows

#: Standard errors by which a shift of torque against speed must exceed a tick to be one: below, it is held at a tick.
SURE = 3.0


def equations_of(rows: Rows, laid: Layout) -> NormalEquations:
    """Normal equations of columns that are laid out and, behind them, a constant."""
    columns = np.column_stack([laid.columns, np.ones(laid.effort.size)])
    noise, width = np.pad(laid.noise, (0, 1)), rows.conditioning.filter.width
    return normal_equations([*laid.owners, OFFSET], columns, laid.effort, rows.time, noise, width)


@dataclass(frozen=True, eq=False)
class Solution:
    """Coefficients of a recording's torque balance with their covariance, and what they leave.

    Attributes:
        rows: of the recording, or of its first part, which determines filter and noise floor.
        hypothesis, laid: of these rows, and its columns.
        whole, equations: of every column and a constant over the whole recording, and of the fitted columns.
        theta: (p,).
        covariance: (p, p).
        reach: of an interval of 95 % in standard errors.
        shift: by which the least residual wants torque behind speed, and its standard error - s.
        held: whether the shift is held at a tick.
    """

    rows: Rows
    hypothesis: Hypothesis
    laid: Layout
    whole: NormalEquations
    equations: NormalEquations
    theta: Array
    covariance: Array
    reach: float
    shift: tuple[float, float]
    held: bool

    def of(self, name: Name, numbers: Array) -> float:
        """That of numbers (p,) which belongs to the column of a name."""
        return float(numbers[self.equations.place(name)])

    @property
    def names(self) -> tuple[Name, ...]:
        """Of the fitted columns (p,)."""
        return self.equations.names

    @cached_property
    def errors(self) -> Array:
        """Standard errors (p,)."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @cached_property
    def power(self) -> float:
        """Sum of squared residuals over the whole recording - the effort's unit squared."""
        return max(self.equations.residual_power(self.theta), 0.0)

    @cached_property
    def residual(self) -> Array:
        """Measured less modelled effort at the rows (m,) - the effort's unit."""
        return self.laid.effort - self._modelled

    @cached_property
    def floor(self) -> Floor:
        """What the sensors' noise leaves in the residual."""
        theta = self.theta[: self.laid.owners.size]
        cut = float(theta[self.laid.owners == DIGIT].sum())
        rounded = rounding(self.rows, self.hypothesis.step, self._modelled, cut)
        return Floor(self.rows, noise_power(self.rows, self.hypothesis, self.laid, theta), self.residual, rounded)

    @cached_property
    def misfit(self) -> Array:
        """Half widths at 95 % from the residual above noise (p,); 0 if there is none."""
        reaches, rms = np.zeros(self.theta.size), float(np.sqrt(np.mean(self.residual**2)))
        if rms <= NOISE_ALONE * self.floor.white:  # a floor in colour is no lower
            return reaches
        columns = self.laid.columns
        if OFFSET in self.names:
            columns = np.column_stack([columns, np.ones(self.residual.size)])
        free = [k for k, name in enumerate(self.names) if not (self.held and name == MISALIGNMENT)]
        reaches[free] = misfit(columns[:, free], self.residual, self.floor.coloured)
        return reaches

    @cached_property
    def _modelled(self) -> Array:
        columns = self.laid.owners.size
        offset = float(self.theta[-1]) if OFFSET in self.names else 0.0
        return self.laid.columns @ self.theta[:columns] + offset


def solve(rows: Rows, hypothesis: Hypothesis, laid: Layout, equations: NormalEquations, offset: bool) -> Solution:
    """Least squares; the shift of torque against speed is limited to a tick unless a larger one is significant.

    A drive latches its signals within one tick. Along a sine, shift and viscous friction are inseparable: noise that
    the drive feeds back gave a false shift of 4 ms and 26 times the friction.

    Args:
        rows: of the recording, or of its first part.
        hypothesis, laid: of these rows, and its columns.
        equations: of the whole recording, a constant last.
        offset: whether the constant is fitted.
    """
    measured = equations if offset else equations.only(lambda name: name != OFFSET)
    informed, beforehand = with_digit(measured, hypothesis.step)
    least = rows.conditioning.effort_noise**2 / rows.conditioning.filter.stride
    theta, inverse = informed.solve()
    unknown = inverse @ beforehand @ inverse
    covariance, reach = estimated(measured.scores(theta), inverse, least)
    covariance = covariance + unknown
    at, tick = measured.place(MISALIGNMENT), rows.scope.latched
    shift, error = float(theta[at]), float(np.sqrt(max(covariance[at, at], 0.0)))
    apart = abs(shift) > min(tick, rows.scope.sample_period) and bool(
        equations.independent_shares((MISALIGNMENT, INERTIA, VISCOUS, COULOMB))[0] >= INDEPENDENT_SHARE
    )
    held = abs(shift) > tick and not (apart and abs(shift) > tick + SURE * error)
    if held:
        theta, _ = informed.solve({MISALIGNMENT: (-tick, tick)})
        covariance, reach = estimated(measured.scores(theta), inverse, least)
        covariance = covariance + unknown
    told = (shift, error) if apart else (0.0, error)
    return Solution(rows, hypothesis, laid, equations, measured, theta, covariance, reach, told, held)


def with_digit(equations: NormalEquations, step: float) -> tuple[NormalEquations, Array]:
    """The equations with a prior of the effort's last digit, if that is a column; and the variance it adds (p, p).

    Where torque and speed change sign together, truncation of the current and dry friction are inseparable. Truncation
    is at most half a step, and the interval of friction includes that range; fitted freely, it took half of it.

    Args:
        equations: of the fitted columns.
        step: of the digit - N*m (N); 0 where it is no column.
    """
    beforehand = np.zeros_like(equations.noise)
    if not step:
        return equations, beforehand
    value, variance = cut_beforehand(step)
    power = max(equations.residual_power(equations.solve()[0]), 0.0) / equations.count
    weight, place = power / variance, equations.place(DIGIT)
    beforehand[place, place] = weight**2 * variance
    return equations.knowing(DIGIT, value, weight), beforehand
