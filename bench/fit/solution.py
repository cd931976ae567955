"""Least squares of a recording's normal equations with honest errors: correlated residuals, a shift, misfit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import scipy  # its special functions load when first used: 0.2 s
from numpy.typing import NDArray

from bench.arrays import Array, rms, symmetric_inverse
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS
from bench.fit.determined import INDEPENDENT_SHARE
from bench.fit.hypothesis import Hypothesis
from bench.fit.layout import DIGIT, Layout, cut_beforehand, rounding
from bench.fit.noise import Floor, noise_power
from bench.fit.normal_equations import Name, NormalEquations, normal_equations
from bench.fit.rows import Rows

#: Andrews' bandwidth minimises the error of the covariance, not of an interval's coverage: on 400 recordings of 6 s
#: with first-order residuals (0.9 a ms) nominal 95 % intervals covered .958/.923/.903 with it, .963/.935/.908 half
#: again as wide, .963/.933/.918 more than twice as wide (J, viscous, Coulomb; tests/fit/test_coverage.py).
WIDENED = 1.5
#: Columns of the plain axis, which take as many degrees of freedom. What effects add is not counted: where residuals
#: are correlated so long that their number matters, a remainder is left, and the interval says nothing of the effect's
#: columns (a servo's pendulum with four effects and ten independent blocks: one degree, an interval of 12.7 errors).
PLAIN = 4
#: Parts of equally many rows by acceleration or speed, and by time.
LEVELS, QUARTERS = 8, 4
#: Residual in noise floors above which something else than noise is left; on 100 recordings of axes that lack nothing
#: 97 lay below.
NOISE_ALONE = 1.12
#: Share of a column's power that one part of the rows may hold at most.
MOST = 0.9


def estimated(scores: Array, inverse: Array, least: float) -> tuple[Array, float]:
    """Covariance (p, p) of coefficients from scores of blocks of time (b, p), and the reach of 95 % in standard errors.

    It is never less than the effort's white noise alone - `least`, the variance between rows - makes it by the
    inverse of the equations' matrix (p, p), and reaches as Student's t does at as many degrees of freedom as there are
    independent blocks.
    """
    middle, bandwidth = long_run_covariance(scores)
    independent = scores.shape[0] / bandwidth
    degrees = max(independent - PLAIN, 1.0)
    covariance = inverse @ middle @ inverse * independent / degrees
    variance, floor = np.diag(covariance), least * np.diag(inverse)
    widened = np.sqrt(np.where(variance > 0.0, np.maximum(variance, floor) / np.maximum(variance, 1e-300), 1.0))
    return covariance * np.outer(widened, widened), float(scipy.special.stdtrit(degrees, 0.975))


def misfit(columns: Array, residual: Array, floor: float) -> Array:
    """How far intervals of 95 % have to reach (p,) because of what stands above the noise; 0 where nothing does.

    Columns (m, p) are in order of time, acceleration and speed first; the floor is the RMS that the noise leaves.
    """
    above = 1.0 - (NOISE_ALONE * floor) ** 2 / max(float(np.mean(residual**2)), 1e-300)
    return np.sqrt(above) * left_out(columns, residual) if above > 0.0 else np.zeros(columns.shape[1])


def left_out(columns: Array, residual: Array) -> Array:
    """How far intervals of 95 % have to reach for coefficients (p,) that depend on which rows they are read from.

    What a model lacks comes back with every repetition of a motion, so its scores are alike from block to block of time
    and a covariance over these does not see it. It differs by the state of motion: coefficients are formed without each
    of eight levels of acceleration, without each of eight of speed, and without each quarter of the recording; the
    largest of the three counts (delete-a-group jackknife, M. H. Quenouille, Biometrika 43, 1956, 353-360). Levels and
    quarters are equal in a mean of their shares of the rows and of the columns' power, so that none takes all rows that
    accelerate, nor all that are slow.
    """
    scale = np.sqrt(np.sum(columns**2, axis=0))
    scaled = columns / np.where(scale > 0.0, scale, 1.0)
    power = scaled**2
    accelerated, moved = np.argsort(power[:, 0]), np.argsort(power[:, 1])
    cuts = [(accelerated, power[:, 0], LEVELS), (moved, power[:, 1], LEVELS)]
    cuts.append((np.arange(residual.size), np.sum(power, axis=1), QUARTERS))
    reaches = _without_each(scaled, residual, [(order, _parts(mass[order], count)) for order, mass, count in cuts])
    return reaches / np.where(scale > 0.0, scale, 1.0)


def _parts(power: Array, count: int) -> list[slice]:
    """Rows (m,) in their order cut into parts equal in the weighted mean of their shares of rows and of power."""
    rows = np.arange(1, power.size + 1) / power.size
    share = rows + (1.0 / (MOST * count)) * (np.cumsum(power) / max(float(np.sum(power)), 1e-300) - rows)
    edges = [0, *np.searchsorted(share, np.arange(1, count) / count).tolist(), power.size]
    return [slice(start, stop) for start, stop in pairwise(edges) if stop > start]


def _without_each(columns: Array, residual: Array, cuts: list[tuple[NDArray[np.intp], list[slice]]]) -> Array:
    """The furthest reach of intervals (p,) by coefficients without each part of the rows (m,) in their order."""
    counts = [len(parts) for _, parts in cuts]
    if min(counts) < 2:
        return np.full(columns.shape[1], np.inf)
    table = np.column_stack([columns, residual])
    sums = np.array([table[order[part]].T @ table[order[part]] for order, parts in cuts for part in parts])
    grams, scores = sums[:, :-1, :-1], sums[:, :-1, -1]
    whole = np.repeat([part.sum(axis=0) for part in np.split(grams, np.cumsum(counts)[:-1])], counts, axis=0)
    moved = np.einsum("gij,gj->gi", symmetric_inverse(whole - grams, 1e-10), scores) ** 2
    reaches = [
        scipy.special.stdtrit(count - 1, 0.975) * np.sqrt((count - 1) / count * squares.sum(axis=0))
        for count, squares in zip(counts, np.split(moved, np.cumsum(counts)[:-1]), strict=True)
    ]
    return np.max(reaches, axis=0)


def long_run_covariance(scores: Array) -> tuple[Array, float]:
    """Covariance (p, p) of the sum of a correlated sequence (b, p) of mean zero, by the quadratic spectral kernel.

    S = sum over lags of k(lag/bandwidth)*Gamma(lag), with the bandwidth - lags, returned too - that is best for a
    first-order process fitted to each column (Andrews, Heteroskedasticity and autocorrelation consistent covariance
    matrix estimation, Econometrica 59(3), 1991, eqs. 2.7, 5.3, 6.2, 6.4).
    """
    count = scores.shape[0]
    bandwidth = _bandwidth(scores)
    one_sided = _quadratic_spectral(np.arange(count) / bandwidth)
    weights = np.concatenate([one_sided, [0.0], one_sided[:0:-1]])
    smoothed = np.fft.irfft(np.fft.rfft(scores, 2 * count, axis=0) * np.fft.rfft(weights)[:, None], 2 * count, axis=0)
    covariance = scores.T @ smoothed[:count]
    return 0.5 * (covariance + covariance.T), bandwidth


def _bandwidth(scores: Array) -> float:
    """WIDENED*1.3221*(a*n)**(1/5), a from first-order fits; between one lag and a quarter of the sequence."""
    if len(scores) < 2:
        return 1.0
    now, before = scores[1:], scores[:-1]
    power = np.sum(before**2, axis=0)
    rho = np.clip(np.sum(now * before, axis=0) / np.where(power > 0.0, power, 1.0), -0.97, 0.97)
    variance = np.mean((now - rho * before) ** 2, axis=0)
    scale = np.where(power > 0.0, power, 1.0)
    relative = (variance / scale) ** 2
    ratio = np.sum(4.0 * rho**2 * relative / (1.0 - rho) ** 8) / max(np.sum(relative / (1.0 - rho) ** 4), 1e-300)
    return float(np.clip(WIDENED * 1.3221 * (ratio * scores.shape[0]) ** 0.2, 1.0, max(1.0, scores.shape[0] / 4.0)))


def _quadratic_spectral(lag: Array) -> Array:
    """Kernel 25/(12*pi**2*x**2)*(sin(6*pi*x/5)/(6*pi*x/5) - cos(6*pi*x/5)), 1 at zero (Andrews 1991, eq. 2.7)."""
    angle = 6.0 * np.pi / 5.0 * np.where(lag == 0.0, 1.0, lag)
    return np.where(lag == 0.0, 1.0, 3.0 / angle**2 * (np.sin(angle) / angle - np.cos(angle)))


#: Standard errors by which a shift of torque against speed must exceed a tick to be one: below, it is held at a tick.
SURE = 3.0


def equations_of(rows: Rows, laid: Layout) -> NormalEquations:
    """Normal equations of columns that are laid out and, behind them, a constant."""
    columns = np.vstack([laid.columns.T, np.ones(laid.effort.size)]).T
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
        reaches = np.zeros(self.theta.size)
        if rms(self.residual) <= NOISE_ALONE * self.floor.white:  # a floor in colour is no lower
            return reaches
        columns = self.laid.columns
        if OFFSET in self.names:
            columns = np.column_stack([columns, np.ones(self.residual.size)])
        free = [k for k, name in enumerate(self.names) if not (self.held and name == MISALIGNMENT)]
        reaches[free] = misfit(columns[:, free], self.residual, self.floor.coloured)
        return reaches

    @cached_property
    def shift_explains(self) -> float:
        """Share that a shift explains of the squares that stand above the noise without one."""
        columns, effort, place = self.laid.columns, self.laid.effort, self.names.index(MISALIGNMENT)
        tables = np.delete(columns, place, axis=1), columns
        without, beside = (
            float(np.mean((effort - table @ np.linalg.lstsq(table, effort, rcond=None)[0]) ** 2)) for table in tables
        )
        above = without - self.floor.white**2
        return (without - beside) / above if above > 0.0 else 0.0

    @cached_property
    def _modelled(self) -> Array:
        columns = self.laid.owners.size
        offset = float(self.theta[-1]) if OFFSET in self.names else 0.0
        return self.laid.columns @ self.theta[:columns] + offset


def solve(rows: Rows, hypothesis: Hypothesis, laid: Layout, equations: NormalEquations, offset: bool) -> Solution:
    """Least squares; the shift of torque against speed is limited to a tick unless a larger one is significant.

    A drive latches its signals within one tick. Along a sine, shift and viscous friction are inseparable: noise that
    the drive feeds back gave a false shift of 4 ms and 26 times the friction.

    Rows are of the recording, or of its first part; equations of all of it, a constant last.
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
    delay = (shift, error) if apart else (0.0, error)
    return Solution(rows, hypothesis, laid, equations, measured, theta, covariance, reach, delay, held)


def with_digit(equations: NormalEquations, step: float) -> tuple[NormalEquations, Array]:
    """The equations with a prior of the effort's last digit, if that is a column; and the variance it adds (p, p).

    Where torque and speed change sign together, truncation of the current and dry friction are inseparable. Truncation
    is at most half a step - N*m (N) -, and the interval of friction includes that range; fitted freely, it took half.
    """
    beforehand = np.zeros_like(equations.noise)
    if not step:
        return equations, beforehand
    value, variance = cut_beforehand(step)
    power = max(equations.residual_power(equations.solve()[0]), 0.0) / equations.count
    weight, place = power / variance, equations.place(DIGIT)
    beforehand[place, place] = weight**2 * variance
    return equations.knowing(DIGIT, value, weight), beforehand
