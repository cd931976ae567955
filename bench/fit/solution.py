"""From named columns to numbers with intervals: normal equations, their solution, the noise floor, honest errors.

Normal equations are gathered block by block in time, in one pass over a recording of any length. Scores of the blocks
give a covariance that counts correlated residuals; what exceeds the noise floor widens the intervals.

The floor is the part of the residual due to the sensors' noise. White noise of effort and speed passes filter and model
with a known spectrum. Real noise need not be white: below the frequencies at which its level was read it may stand
higher. The residual shows by how much where it is quietest - noise is there at every moment and every frequency, what a
model lacks comes and goes with the motion - so the lowest tenth over windows of time is taken at each frequency, and a
first-order spectrum is laid through.

    S(omega) = S_white(omega)*(1 + c/(1 + (omega/omega_c)**2))

Added to it is the residual of the last digit of a current in coarse steps: white where noise of the sensor moves the
signal over the steps; where it does not, the error follows the signal's slow way through them and passes the filter: it
is then read off the modelled torque, rounded in the same steps.

    e = q*round(M/q) - M, which noise of a deviation s reduces to exp(-2*(pi*s/q)**2)

q - step; M - modelled torque - N*m (N).
Source: B. Widrow, I. Kollar, Quantization Noise, 2008 (characteristic function of a dithered quantiser).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
import scipy  # its special functions load when first used: 0.2 s
from numpy.typing import NDArray

from bench.arrays import Array, rms, symmetric_inverse
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS
from bench.effects.effect import Columns, Coupling
from bench.fit.hypothesis import BASE, DIGIT, Hypothesis, Layout, Name, delays, frequencies, lay_out
from bench.fit.rows import ONE_WAY, Rows

#: Blocks of time in filter widths: neighbouring blocks then share little except the residual's own correlation.
BLOCK_WIDTHS = 8.0
#: Blocks that a covariance needs at most, of a recording and of each of its parts.
BLOCKS = 512
#: Power of a combination of scaled columns below which it is none but rounding.
ROUNDING = 1e-13
#: Norm of a column, in its unit, below which its squares underflow.
VANISHED = 1e-140
#: Steps of a bounded least squares for each bound, far above the two or three that it takes.
MOST_TURNS = 20
#: Share of the largest eigenvalue below which columns that are held against another one count as dependent.
DEPENDENT = 1e-9
#: Rows a block up to which a product for each costs more than sums over all of them; at 50 both cost the same.
SHORT = 24
#: Least share of a column's power that the others do not explain; 1 % inflates its standard error tenfold.
INDEPENDENT_SHARE = 0.01
#: Standard errors by which a shift of torque against speed must exceed a tick to be one: below, it is held at a tick.
SURE = 3.0
#: Share of what exceeds the noise that a delay has to explain; friction that a model lacks looked like one by 17 %.
A_DELAY = 0.25
#: Factor on Andrews' bandwidth, which is best for the covariance, not for intervals (tests/fit/test_intervals.py):
#: of 95 % nominal .958/.923/.903 are covered without it, .963/.935/.908 with it (J, viscous, Coulomb).
WIDENED = 1.5
#: Columns of the plain axis, which take as many degrees of freedom; those of effects are not counted.
PLAIN = 4
#: Parts of equally many rows by acceleration or speed, and by time.
LEVELS, QUARTERS = 8, 4
#: Residual in noise floors above which it is more than noise; of 100 recordings of axes that lack nothing 97 lay below.
NOISE_ALONE = 1.12
#: Share of what shows a coefficient that one part of the rows may have at most.
MOST = 0.9
#: Rows of a window, longer ones first, and windows of a length that it takes; else white noise is assumed.
LENGTHS, ENOUGH = (128, 64), 24
#: Lowest bin clear of the window's own leakage, and share of the strongest density below which a bin is not read.
LOWEST, HEARD = 3, 0.03
#: Power of a line in Hann's window, at its bin and the next.
HANN = np.array([1.0, 4.0, 1.0]) / 6.0
#: Quantile over windows that counts as quiet: of a lag the lower quartile holds 600 times the noise, the tenth 6 to 12.
QUIET = 0.1
#: Excess at low frequency that chance makes in a white recording, and that is therefore not called colour.
CHANCE = 0.4
#: Excesses tried, and corners, from the lowest frequency read to this many times the highest.
EXCESSES = np.r_[0.0, np.geomspace(CHANCE, 1e4, 60)]
CORNERS, BEYOND = 16, 3.0


@dataclass(frozen=True)
class NormalEquations:
    """Sums over blocks of time, from which estimate, residual and a covariance for correlated residuals follow.

    Attributes:
        names: of the columns (p,).
        gram: X'X of each block - (b, p, p).
        moment: X'y of each block - (b, p).
        power: y'y of each block - (b,).
        rows: of each block - (b,).
        noise: (p, p) covariance of the noise of the columns in a row.
        known: inertia by which the effort has the noise of the acceleration, the first column - kg*m**2 (kg).
    """

    names: tuple[Name, ...]
    gram: Array
    moment: Array
    power: Array
    rows: NDArray[np.int64]
    noise: Array
    known: float = 0.0

    def only(self, kept: Callable[[Name], bool]) -> NormalEquations:
        """The same equations for columns of some names only."""
        at = [place for place, name in enumerate(self.names) if kept(name)]
        gram, names = self.gram[:, at][:, :, at], tuple(self.names[place] for place in at)
        return replace(self, names=names, gram=gram, moment=self.moment[:, at], noise=self.noise[np.ix_(at, at)])

    @cached_property
    def count(self) -> int:
        """Rows of all blocks."""
        return int(self.rows.sum())

    @cached_property
    def total(self) -> Array:
        """X'X of all rows - (p, p)."""
        return self.gram.sum(axis=0)

    @cached_property
    def matrix(self) -> Array:
        """X'X less what sensor noise put into it - (p, p)."""
        return self.total - self.count * self.noise

    @cached_property
    def moments(self) -> Array:
        """X'y of all rows less what noise put into it, by which the known effort has that of the motion - (p,)."""
        return self.moment.sum(axis=0) + self.count * self.known * self.noise[:, 0]

    @cached_property
    def one_way(self) -> str | None:
        """`forward` or `backward` if the axis moves one way only: Coulomb friction and offset are then inseparable."""
        mean_direction = self.total[self.names.index(COULOMB), self.names.index(OFFSET)] / self.count
        if 0.5 * (1.0 - abs(mean_direction)) >= ONE_WAY:
            return None
        return "forward" if mean_direction > 0.0 else "backward"

    def independent_shares(self, names: Sequence[Name]) -> Array:
        """Share of the power of some columns that neither is noise nor the others explain (k,); below 0 of noise."""
        places, at = [self.names.index(name) for name in names], np.arange(len(names))
        power = np.diag(self.total)[places]
        scale = np.sqrt(np.where(power > 0.0, power, 1.0))
        matrix = self.matrix[np.ix_(places, places)] / np.outer(scale, scale)
        others = np.argsort(np.eye(len(names), dtype=bool), axis=1, kind="stable")[:, :-1]
        beside, between = matrix[others, at[:, None]], matrix[others[:, :, None], others[:, None, :]]
        return np.diag(matrix) - np.einsum("ki,kij,kj->k", beside, symmetric_inverse(between, DEPENDENT), beside)

    def noise_share(self, name: Name) -> float:
        """Share of noise in the power of a column."""
        place = self.names.index(name)
        return float(self.count * self.noise[place, place] / max(self.total[place, place], 1e-300))

    def solved(self) -> tuple[Array, Array]:
        """Coefficients (p,) of all rows, and the inverse of the matrix that they came from; see `solved`."""
        return solved(self.total, self.moments, self.count * self.noise)

    def scores(self, theta: Array) -> Array:
        """X'(y - X*theta) of each block, less the part of it that is due to noise in the columns - (b, p)."""
        noise = self.noise @ theta + self.known * self.noise[:, 0]
        return self.moment - self.gram @ theta + np.outer(self.rows, noise)

    def residual_power(self, theta: Array) -> float:
        """Sum of squared residuals of all rows - the effort's unit squared."""
        moment = self.moment.sum(axis=0)
        return max(float(self.power.sum() - 2.0 * theta @ moment + theta @ self.total @ theta), 0.0)


def equations_of(rows: Rows, laid: Layout, edges: NDArray[np.int64] | None = None) -> NormalEquations:
    """Normal equations of columns that are laid out and, behind them, a constant; of blocks between edges (b + 1,)."""
    edges = block_edges(rows.time, rows.conditioning.filter.width) if edges is None else edges
    table = np.vstack([laid.columns.T, np.ones(laid.effort.size), laid.effort])
    return equations((*laid.owners, OFFSET), table, np.pad(laid.noise, (0, 1)), edges, laid.known)


def equations(
    names: tuple[Name, ...], table: Array, noise: Array, edges: NDArray[np.int64], known: float = 0.0
) -> NormalEquations:
    """Normal equations of columns of these names, which with the effort behind them are the rows of a table (p + 1, m).

    `noise`: of the columns in a row (p, p); `edges`: of the blocks (b + 1,); `known`: as of the equations.
    """
    sums = _products(table, edges)
    return NormalEquations(names, sums[:, :-1, :-1], sums[:, :-1, -1], sums[:, -1, -1], np.diff(edges), noise, known)


def _products(table: Array, edges: NDArray[np.int64]) -> Array:
    """Products of columns, which are the rows of a table (k, m), over each block between edges (b + 1,) - (b, k, k).

    Of long blocks one by one; of short ones column by column over all blocks at once, which on 3 s at 1 kHz takes a
    fifth of the time.
    """
    width, count = len(table), edges.size - 1
    if table.shape[1] > SHORT * count:
        return np.array([table[:, start:stop] @ table[:, start:stop].T for start, stop in pairwise(edges.tolist())])
    sums = np.empty((width, width, count))
    for k in range(width):
        sums[k, : k + 1] = sums[: k + 1, k] = np.add.reduceat(table[: k + 1] * table[k], edges[:-1], axis=1)
    return sums.transpose(2, 0, 1)


def block_edges(time: Array, width: float) -> NDArray[np.int64]:
    """First rows of blocks of BLOCK_WIDTHS filter widths - s -, of at most BLOCKS longer ones, and the end."""
    count = int(np.clip((time[-1] - time[0]) / (BLOCK_WIDTHS * width), 1, BLOCKS))
    borders = np.linspace(time[0], time[-1], count + 1)[1:-1]
    return np.unique(np.concatenate([[0], np.searchsorted(time, borders), [time.size]]))


def join(parts: Sequence[NormalEquations]) -> NormalEquations:
    """Those of a recording from those of its parts, in order, of the same columns; at most BLOCKS longer blocks."""
    if len(parts) == 1:
        return parts[0]
    names = ("gram", "moment", "power", "rows")
    blocks = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    starts = np.arange(0, blocks["rows"].size, -(-blocks["rows"].size // BLOCKS))
    return replace(parts[0], **{name: np.add.reduceat(values, starts) for name, values in blocks.items()})


def solved(gram: Array, moment: Array, noise: Array) -> tuple[Array, Array]:
    """Coefficients (p,) of X'X (p, p) and X'y (p,), and the inverse of the matrix that they came from.

    Noise in a column inflates its own square and draws its coefficient towards zero; taking the known power `noise`
    (p, p) out makes least squares consistent (Soderstrom, Errors-in-variables methods in system identification,
    Automatica 43(6), 2007, eq. 40).
    """
    scale = np.sqrt(np.diag(gram))
    scale = np.where(scale > VANISHED, scale, 1.0)
    scales = np.outer(scale, scale)
    inverse = symmetric_inverse((gram - noise) / scales, ROUNDING) / scales
    return inverse @ moment, inverse


def bounded(
    gram: Array, moment: Array, noise: Array, bounds: Mapping[int, tuple[float, float]]
) -> tuple[Array, tuple[int, ...]]:
    """Coefficients (p,) of the least squares of `solved` within bounds by places, and the places held at one.

    An active set (P. B. Stark, R. L. Parker, Computational Statistics 10, 1995, 129-141): the free coefficients are
    solved for; the first that would leave its range on the way there is held at its bound; a held one whose squares
    fall inwards is released. It ends in finitely many steps, as squares fall in each.
    """
    theta, _ = solved(gram, moment, noise)
    low, high = np.full((2, theta.size), [[-np.inf], [np.inf]])
    for place, (least, most) in bounds.items():
        low[place], high[place] = least, most
    held = (theta < low) | (theta > high)
    if not held.any():
        return theta, ()
    theta, matrix = np.clip(theta, low, high), gram - noise
    for _ in range(MOST_TURNS * len(bounds)):
        free = ~held
        rest = moment[free] - matrix[np.ix_(free, held)] @ theta[held]
        aim = theta.copy()
        aim[free] = solved(gram[np.ix_(free, free)], rest, noise[np.ix_(free, free)])[0]
        beyond = np.flatnonzero((aim < low) | (aim > high))
        if beyond.size:
            ends = np.where(aim < low, low, high)[beyond]
            shares = (ends - theta[beyond]) / (aim - theta)[beyond]
            first = int(np.argmin(shares))
            theta += shares[first] * (aim - theta)
            theta[beyond[first]], held[beyond[first]] = ends[first], True
            continue
        theta = aim
        slope = (matrix @ theta - moment) / np.sqrt(np.maximum(np.diag(gram), 1e-300))
        inwards = np.where(held & (low < high), np.where(theta <= low, -slope, slope), 0.0)
        worst = int(np.argmax(inwards))
        if inwards[worst] <= ROUNDING * float(np.abs(moment / np.sqrt(np.maximum(np.diag(gram), 1e-300))).max()):
            break
        held[worst] = False
    return theta, tuple(np.flatnonzero(held).tolist())


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
        return float(numbers[self.names.index(name)])

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
        return self.equations.residual_power(self.theta)

    @cached_property
    def residual(self) -> Array:
        """Measured less modelled effort at the rows (m,) - the effort's unit."""
        columns = self.laid.owners.size
        offset = float(self.theta[-1]) if OFFSET in self.names else 0.0
        return self.laid.effort - (self.laid.columns @ self.theta[:columns] + offset)

    @cached_property
    def floor(self) -> Floor:
        """The residual due to the sensors' noise."""
        return Floor(self.rows, self.hypothesis, self.laid, self.theta[: self.laid.owners.size], self.residual)

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

    @property
    def delayed(self) -> bool:
        """Whether torque and speed surely differ by more than a sample, which explains the residual without a shift."""
        shift, error = self.shift
        return abs(shift) > max(self.rows.scope.sample_period, SURE * error) and self.shift_explains > A_DELAY

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


def solution_of(rows: Rows, hypothesis: Hypothesis, offset: bool) -> Solution:
    """The solution of a hypothesis; with a constant, if it is asked for and the axis moves in both directions."""
    laid = lay_out(rows, hypothesis)
    equations = equations_of(rows, laid)
    return solve(rows, hypothesis, laid, equations, offset and equations.one_way is None)


def solve(rows: Rows, hypothesis: Hypothesis, laid: Layout, equations: NormalEquations, offset: bool) -> Solution:
    """Least squares; the shift of torque against speed is limited to a tick unless a larger one is significant.

    A drive latches its signals within one tick. Along a sine, shift and viscous friction are inseparable: noise that
    the drive feeds back gave a false shift of 4 ms and 26 times the friction.

    Rows are of the recording, or of its first part; equations of all of it, a constant last.
    """
    fitted = equations if offset else equations.only(lambda name: name != OFFSET)
    weight, value, variance = _digit_beforehand(fitted, hypothesis.step)
    gram, moment = fitted.total + np.diag(weight), fitted.moments + weight * value
    noise = fitted.count * fitted.noise
    theta, inverse = solved(gram, moment, noise)
    unknown = inverse @ np.diag(weight**2 * variance) @ inverse
    least = rows.conditioning.effort_noise**2 / rows.conditioning.filter.stride
    covariance, reach = estimated(fitted.scores(theta), inverse, least)
    at, tick = fitted.names.index(MISALIGNMENT), rows.scope.latched
    shift, error = float(theta[at]), float(np.sqrt(max((covariance + unknown)[at, at], 0.0)))
    apart = abs(shift) > min(tick, rows.scope.sample_period) and bool(
        equations.independent_shares((MISALIGNMENT, INERTIA, VISCOUS, COULOMB))[0] >= INDEPENDENT_SHARE
    )
    held = abs(shift) > tick and not (apart and abs(shift) > tick + SURE * error)
    if held:
        theta, _ = bounded(gram, moment, noise, {at: (-tick, tick)})
        covariance, reach = estimated(fitted.scores(theta), inverse, least)
    delay = (shift if apart else 0.0, error)
    return Solution(rows, hypothesis, laid, equations, fitted, theta, covariance + unknown, reach, delay, held)


def _digit_beforehand(equations: NormalEquations, step: float) -> tuple[Array, float, float]:
    """What is known of the effort's last digit before it is measured, as if it had been: weights (p,), value, variance.

    Where torque and speed change sign together, truncation of the current and dry friction are inseparable. Truncation
    is at most half a step - N*m (N) -, and the interval of friction includes that range; fitted freely, it took half.
    The weight is the variance of a row over that of the value; all are 0 where the digit does not matter.
    """
    if not step:
        return np.zeros(len(equations.names)), 0.0, 0.0
    value, variance = cut_beforehand(step)
    weight = equations.residual_power(equations.solved()[0]) / equations.count / variance
    return weight * (np.array(equations.names, dtype=object) == DIGIT), value, variance


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
    widened = np.ones_like(variance)
    np.divide(np.maximum(variance, floor), np.maximum(variance, 1e-300), out=widened, where=variance > 0.0)
    widened = np.sqrt(widened)
    return covariance * np.outer(widened, widened), float(scipy.special.stdtrit(degrees, 0.975))


def misfit(columns: Array, residual: Array, floor: float) -> Array:
    """How far intervals of 95 % have to reach (p,) because of what exceeds the noise; 0 where nothing does.

    Columns (m, p) are in order of time, acceleration and speed first; the floor is the RMS of the noise.
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
    scale = np.where(scale > 0.0, scale, 1.0)
    table = np.column_stack([columns / scale, residual])
    power = table[:, :-1] ** 2
    cuts = [(np.argsort(power[:, k]), power[:, k], LEVELS) for k in (0, 1)]
    cuts.append((np.arange(residual.size), np.sum(power, axis=1), QUARTERS))
    reaches = [_without_each(table[order], _edges(mass[order], count)) for order, mass, count in cuts]
    return np.max(reaches, axis=0) / scale


def _edges(power: Array, count: int) -> NDArray[np.intp]:
    """First rows, and the end, of parts (m,) equal in the weighted mean of their shares of rows and of power."""
    rows = np.arange(1, power.size + 1) / power.size
    share = rows + (1.0 / (MOST * count)) * (np.cumsum(power) / max(float(np.sum(power)), 1e-300) - rows)
    return np.unique(np.r_[0, np.searchsorted(share, np.arange(1, count) / count), power.size])


def _without_each(table: Array, edges: NDArray[np.intp]) -> Array:
    """Reach of intervals (p,) by coefficients without each part of the rows of columns and residual (m, p + 1).

    A part that has nearly all that shows a coefficient, as slow rows have of friction that falls with speed, shows
    nothing by being left out: that coefficient is held.
    """
    count = edges.size - 1
    if count < 2:
        return np.full(table.shape[1] - 1, np.inf)
    sums = np.array([table[start:stop].T @ table[start:stop] for start, stop in pairwise(edges.tolist())])
    grams, scores = sums[:, :-1, :-1], sums[:, :-1, -1]
    whole, free = grams.sum(axis=0), np.ones_like(scores, dtype=bool)
    for _ in range(free.shape[1]):
        shares = _shown(whole - grams, free) / _shown(whole, free)
        least = np.argmin(shares, axis=1)
        short = np.flatnonzero(np.min(shares, axis=1) < 1.0 - MOST)
        if not short.size:
            break
        free[short, least[short]] = False
    others = (whole - grams) * (free[:, :, None] & free[:, None, :])
    moved = np.einsum("gij,gj->gi", symmetric_inverse(others + np.eye(free.shape[1]) * ~free[:, None], 1e-10), scores)
    return scipy.special.stdtrit(count - 1, 0.975) * np.sqrt((count - 1) / count * ((free * moved) ** 2).sum(axis=0))


def _shown(grams: Array, free: NDArray[np.bool_]) -> Array:
    """Power of each free column that the other free ones do not explain (g, p), by products of columns (g, p, p)."""
    among = grams * (free[:, :, None] & free[:, None, :])
    places = np.arange(free.shape[1])
    among[:, places, places] += np.where(free, ROUNDING, 1.0)
    return 1.0 / np.einsum("gii->gi", np.linalg.inv(among))


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
    smoothed = np.fft.irfft(np.fft.rfft(scores.T, 2 * count) * np.fft.rfft(weights), 2 * count)
    covariance = smoothed[:, :count] @ scores
    return 0.5 * (covariance + covariance.T), bandwidth


def _bandwidth(scores: Array) -> float:
    """WIDENED*1.3221*(a*n)**(1/5), a from first-order fits; between one lag and a quarter of the sequence."""
    if len(scores) < 2:
        return 1.0
    now, before = scores[1:], scores[:-1]
    power = np.sum(before**2, axis=0)
    power = np.where(power > 0.0, power, 1.0)
    rho = np.clip(np.sum(now * before, axis=0) / power, -0.97, 0.97)
    relative = (np.mean((now - rho * before) ** 2, axis=0) / power) ** 2
    ratio = np.sum(4.0 * rho**2 * relative / (1.0 - rho) ** 8) / max(np.sum(relative / (1.0 - rho) ** 4), 1e-300)
    return float(np.clip(WIDENED * 1.3221 * (ratio * scores.shape[0]) ** 0.2, 1.0, max(1.0, scores.shape[0] / 4.0)))


def _quadratic_spectral(lag: Array) -> Array:
    """Kernel 25/(12*pi**2*x**2)*(sin(6*pi*x/5)/(6*pi*x/5) - cos(6*pi*x/5)), 1 at zero (Andrews 1991, eq. 2.7)."""
    angle = 6.0 * np.pi / 5.0 * np.where(lag == 0.0, 1.0, lag)
    return np.where(lag == 0.0, 1.0, 3.0 / angle**2 * (np.sin(angle) / angle - np.cos(angle)))


@dataclass(frozen=True, eq=False)
class Floor:
    """RMS of noise in the residual of a hypothesis.

    Attributes:
        rows: the recording.
        hypothesis, layout: what was fitted, and its columns.
        theta: their coefficients (p,).
        residual: (m,) of the used rows - N*m (N).
    """

    rows: Rows
    hypothesis: Hypothesis
    layout: Layout
    theta: Array
    residual: Array

    @cached_property
    def white(self) -> float:
        """Of its white part alone - N*m (N)."""
        return self._rms(self._densities(self._omega)[1])

    @cached_property
    def coloured(self) -> float:
        """Of all of it - N*m (N)."""
        excess, corner = self._colour()
        if not excess:
            return self.white
        white, lines = self._densities(self._omega)
        return self._rms(lines + white * excess / (1.0 + (self._omega / corner) ** 2))

    @cached_property
    def _acting(self) -> float:
        """Torque that acts per reported torque, on average; 1 where no torque is known, against which it would differ.

        The residual is one of the reported torque, in which noise of the motion is as much larger.
        """
        rows, share = self.rows, 1.0
        if not rows.stretches[0].signals.known:
            return share
        more = replace(rows.joined, torque=rows.joined.torque + (step := 1e-3 * rms(self.layout.effort)))
        for index, term in enumerate(self.hypothesis.terms):
            if isinstance(term.effect, Columns) and (term.effect.copies_torque or term.effect.rescales_torque):
                made = (term.effect.columns(signals, term.shape) for signals in (rows.joined, more))
                strengths = self.theta[self.layout.owners == index].tolist()
                for strength, ((low, _),), ((high, _),) in zip(strengths, *made, strict=True):
                    share -= strength * float(np.mean(high - low)) / step
        return max(share, 1e-9)

    @cached_property
    def _omega(self) -> Array:
        highest = np.pi / self.rows.conditioning.filter.sample_period
        return frequencies(self.hypothesis.couplings, highest, 2048)

    def _rms(self, spectrum: Array) -> float:
        """Of a spectrum (k,) over all frequencies, and of of the rounding of the effort."""
        period = self.rows.conditioning.filter.sample_period
        return math.hypot(float(np.sqrt(period / np.pi * np.trapezoid(spectrum, self._omega))), self._rounded)

    @cached_property
    def _rounded(self) -> float:
        cut = float(self.theta[self.layout.owners == DIGIT].sum())
        return rounding(self.rows, self.hypothesis.step, self.layout.effort - self.residual, cut)

    def _densities(self, omega: Array) -> Array:
        """Density at angular frequencies (k,) of white noise, and of it with the lines of rounding (2, k)."""
        conditioning = self.rows.conditioning
        white = np.full(omega.size, conditioning.source_noise**2)
        power = self.power(omega, np.stack([white, conditioning.source_power(omega)]))
        return np.exp(-((omega * conditioning.filter.width) ** 2)) * power

    def power(self, omega: Array, source: Array) -> Array:
        """Power of noise of effort and speed in the torque balance before the filter - (N*m)**2 (N**2) - (..., k).

        s_M**2*|(1 + tau*s)*(1 + T*s)|**2 + s_w**2*|((J + J_p)*s + K_w)*(1 + lag*s) + ...|**2
        + s_p**2*|s*(1 + lag*s)*(1 + J_l/J_k*G)|**2

        J_p - inertia by which the known momentum has the speed's noise: of a joint where the arm is, less that in the
        configuration of the MJCF; s_p - what else of noise it has; G - of a coupling through which known torque passes,
        as it acts on links of inertia J_k behind it: load's acceleration over the motor's, less one.

        Args:
            omega: angular frequencies - rad/s (k,).
            source: power there of the noise of the signal that speed is taken from - its unit squared (..., k).
        """
        conditioning, theta, owners = self.rows.conditioning, self.theta, self.layout.owners
        moving, _, lag = delays(self.rows, self.hypothesis)
        s = np.asarray(1j * omega, dtype=np.complex128)
        kinetic = (theta[BASE.index(INERTIA)] + self.layout.known) * s + theta[BASE.index(VISCOUS)]
        links, behind = np.ones_like(s), self.rows.stretches[0].signals.link_inertia
        for index, term in enumerate(self.hypothesis.terms):
            if isinstance(term.effect, Coupling):
                transfer = term.effect.noise_of_motion(term.shape, omega)
                kinetic = kinetic + theta[owners == index][0] * s * transfer
                links = links + theta[owners == index][0] / behind * transfer if behind > 0.0 else links
        kinetic = kinetic * (1.0 + moving * s) * (s if conditioning.source == "position" else 1.0)
        late = (1.0 + (self.hypothesis.shift + theta[BASE.index(MISALIGNMENT)]) * s) * (1.0 + lag * s)
        effort = conditioning.effort_noise**2 * _square(late)
        known = conditioning.known_noise**2 * _square((1.0 + moving * s) * s * links)
        return effort + (known + source * _square(kinetic)) / self._acting**2

    def _colour(self) -> tuple[float, float]:
        """Excess c at low frequency over white noise, and its corner omega_c - rad/s; (0, 1) where the noise is white.

        Lines of rounding come and go with the speed, and stay with a steady one: neither is colour.
        """
        windows, smooth = self._windows(), self.rows.conditioning.filter
        count, length = windows.shape
        period = smooth.stride * smooth.sample_period
        omega = np.pi / period * np.arange(length // 2 + 1) / max(length // 2, 1)
        white, lines = self._densities(omega) / smooth.stride
        read = np.flatnonzero(white > HEARD * white.max())
        read = read[read >= LOWEST]
        if not count or read.size < LOWEST:
            return 0.0, 1.0
        taper = np.hanning(length)
        spectra = np.abs(np.fft.rfft(windows * taper, axis=1)[:, read]) ** 2 / np.sum(taper**2)
        known = np.maximum(white, np.convolve(lines, HANN, "same"))[read]
        # of exponential variables, what the quiet quantile is to their mean, from expected order statistics
        quiet = np.interp(QUIET * (count - 1), np.arange(count), np.cumsum(1.0 / np.arange(count, 0, -1)))
        ratio = np.quantile(spectra, QUIET, axis=0) / quiet / known
        corners, levels = _levels(tuple(read.tolist()))
        misfit = np.sum(np.abs(levels - np.log(ratio)), axis=2)  # a sharp line sways a sum of magnitudes little
        excess, corner = np.unravel_index(int(np.argmin(misfit)), misfit.shape)
        return float(EXCESSES[excess]), float(corners[corner] * omega[1])

    def _windows(self) -> Array:
        """Half-overlapping windows of neighbouring rows, each less its straight line (k, length); none if too few."""
        used = tuple(part.used.tobytes() for part in self.rows.stretches)
        for length in LENGTHS:
            starts = _starts(used, length)
            if starts.size >= ENOUGH:
                found = self.residual[starts[:, None] + np.arange(length)]
                ramp = np.linspace(-1.0, 1.0, length)
                return found - found.mean(axis=1, keepdims=True) - np.outer(found @ ramp / (ramp @ ramp), ramp)
        return np.empty((0, LENGTHS[-1]))


def _square(values: NDArray[np.complex128]) -> Array:
    """Squared magnitudes, whose root NumPy would draw first."""
    return values.real**2 + values.imag**2


@lru_cache(maxsize=8)
def _levels(read: tuple[int, ...]) -> tuple[Array, Array]:
    """Corners tried (c,) in bins, and by each excess and corner the logarithm of the colour at bins (e, c, bins)."""
    corners = np.geomspace(read[0], BEYOND * read[-1], CORNERS)
    shapes = 1.0 / (1.0 + (np.array(read) / corners[:, None]) ** 2)
    return corners, np.log1p(EXCESSES[:, None, None] * shapes)


@lru_cache(maxsize=8)
def _starts(used: tuple[bytes, ...], length: int) -> NDArray[np.int64]:
    """First rows of the windows that span no gap."""
    found, offset = [], 0
    for raw in used:
        rows = np.flatnonzero(np.frombuffer(raw, dtype=bool))
        runs = np.split(np.arange(rows.size), np.flatnonzero(np.diff(rows) != 1) + 1)
        found += [offset + np.arange(run[0], run[-1] - length + 2, length // 2) for run in runs if run.size >= length]
        offset += rows.size
    return np.concatenate(found) if found else np.empty(0, dtype=np.int64)


def cut_beforehand(step: float) -> tuple[float, float]:
    """Middle and variance of what may be cut off, nothing to half a step - N*m (N) -, before it is measured."""
    return 0.25 * step, (0.5 * step) ** 2 / 12.0


def rounding(rows: Rows, step: float, modelled: Array, cut: float) -> float:
    """RMS residual of the last digit of an effort, through the filter - N*m (N).

    Args:
        rows: the recording.
        step: of the digit - N*m (N); 0 where it does not matter.
        modelled: reported effort at the used rows - N*m (N) - (m,).
        cut: what was found to be cut off - N*m (N): from a quarter of a step on it was, below it was rounded.
    """
    if not step:
        return 0.0
    conditioning = rows.conditioning
    free = max(conditioning.effort_noise**2 - step**2 / 12.0, 0.0)
    followed = np.exp(-2.0 * np.pi**2 * free / step**2)
    whole = np.trunc if cut > 0.25 * step else np.round
    errors = []
    for part in rows.stretches:
        torque = np.interp(part.signals.time, rows.time, modelled + cut * np.sign(modelled))
        reported = step * whole(torque / step)
        (error,) = conditioning.filter(reported + cut * np.sign(reported) - torque, 0)
        errors.append(error[part.used])
    return float(followed) * rms(np.concatenate(errors))
