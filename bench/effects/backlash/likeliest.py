"""The likeliest dead zone: the load is driven along the recorded motion for a grid of gaps and contacts.

Impacts are short and hard, and the instant of one hangs on how the load left the other side of the gap: a few rows are
far off whatever the shape. So shapes are compared by Cauchy's likelihood, sum(log(1 + (r/s)**2)), which lets them be.
Source: P. J. Huber, E. M. Ronchetti, Robust Statistics, 2nd ed., 2009, ch. 7.

A softer contact looks like a wider gap, and each impact errs by its own instant: a ridge along which the likelihood is
rough, so that its curvature at the top tells nothing of how far the shape is open. What tells is how the likeliest
shape moves when stretches of the recording are resampled with replacement (block bootstrap).
Source: B. Efron, R. J. Tibshirani, An Introduction to the Bootstrap, 1993, sec. 8.6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.effects.acting import Spring
from bench.effects.backlash.dead_zone import dead_zone_columns
from bench.effects.effect import Fitted
from bench.effects.grids import FREQUENCY, extended
from bench.effects.signals import Scope

#: Gaps in travel of the motor at the recording's RMS speed over one filter width, wide ones closer, as impacts shift by
#: more widths of the filter the wider the gap is; contacts - rad/s; damping ratio.
GAPS = (*np.geomspace(0.03, 0.8, 16).tolist(), *np.geomspace(0.88, 8.0, 24).tolist())
CONTACTS = tuple(2.0 * np.pi * f for f in (40.0, 80.0, 130.0, 210.0))
DAMPING = 0.4
#: Offsets around a shape in each round of refinement - gap, frequency, damping - and their size at first, as factor
#: e**offset. Refinement starts from the likeliest shapes of several contacts, and ends with the likeliest of all.
OFFSETS = np.stack([m.ravel() for m in np.meshgrid(np.linspace(-1, 1, 5), [-1, 0, 1], [-1, 0, 1], indexing="ij")], 1)
SPREAD = (0.12, 0.4, 0.5)
ROUNDS, STARTS, ALL_STARTS = 6, 3, 2
#: Residual in noise floors beyond which a row counts less and less, and reweightings of the least squares.
SCALE, REWEIGHTED = 3.0, 6
#: Samples of all shapes tried at once, which bounds memory: 8 bytes each, some four times over.
TOGETHER = 4_000_000

#: Factors e**x around a shape that are compared for its spread: of gap, frequency and damping.
AROUND = (np.linspace(-0.12, 0.12, 7), np.linspace(-0.6, 0.6, 5), np.linspace(-0.5, 0.5, 3))
#: Length of what is drawn: longer than a load rings after an impact - s.
STRETCH = 0.2
#: Standard errors that all resampled recordings share, as shares: rebounds run faster than samples of 1 ms follow.
#: Of 11 drawn axes (`python -m tests.studies.blind --only backlash --seed 9`) ten gaps came out within 2 % and one 4 %
#: too narrow; frequencies of contact 15 % too low on average and 22 % off by root mean square, of which resampling
#: shows 14 %; damping 1.5 to 7 times too high.
SHARED = np.array([0.01, 0.16, 0.32])
#: Resampled recordings.
DRAWS = 400


@dataclass(frozen=True)
class Likely:
    """A dead zone's shape (4,), its negative logarithm of likelihood, and the load's spring rate that comes of it."""

    shape: Array
    misfit: float
    spring_rate: float

    def around(self, factors: Array) -> Array:
        """Shapes (k, 4) around it, with the spring that was found beside it."""
        return np.column_stack([self.shape[:3] * factors, np.full(len(factors), self.spring_rate)])


def likeliest_shape(fitted: Fitted) -> tuple[float, ...]:
    """Gap, contact's frequency and damping ratio, and spring's rate beside a fit without them; see `load_positions`."""

    def likeliest(shapes: Array) -> list[Likely]:
        columns = _columns(fitted, shapes)
        found = (_likely(fitted, shape, column) for shape, column in zip(shapes, columns.T, strict=True))
        return sorted(found, key=lambda likely: likely.misfit)

    travel = fitted.scope.rms_speed * fitted.scope.width
    contacts = contacts_of(fitted.scope)
    axes = [np.array(GAPS) * travel, np.array(contacts), np.array([DAMPING]), np.array(sorted(_spring_rates(fitted)))]
    tried = likeliest(np.stack([m.ravel() for m in np.meshgrid(*axes, indexing="ij")], axis=1))
    starts = [next(found for found in tried if found.shape[1] == contact) for contact in contacts]
    starts = sorted(starts, key=lambda likely: likely.misfit)[:STARTS]
    for level in range(1, ROUNDS):
        offsets = np.exp(OFFSETS * np.array(SPREAD) * 0.6 ** (level - 1))
        around = np.concatenate([start.around(offsets) for start in starts])
        tried, size = likeliest(around), len(offsets)
        groups = [{row.tobytes() for row in around[k * size : (k + 1) * size]} for k in range(len(starts))]
        refined = [next(found for found in tried if found.shape.tobytes() in group) for group in groups]
        starts = [min(pair, key=lambda likely: likely.misfit) for pair in zip(starts, refined, strict=True)]
        starts = sorted(starts, key=lambda likely: likely.misfit)[: STARTS if level < ALL_STARTS else 1]
    return tuple(float(value) for value in starts[0].shape)


def contact_spread(fitted: Fitted, shape: Array, place: int) -> Array:
    """Covariance (3, 3) of gap, frequency and damping of a fit's dead zone, of a shape (4,) and a column's place."""
    offsets = np.stack([m.ravel() for m in np.meshgrid(*AROUND, indexing="ij")], axis=1)
    shapes = np.column_stack([shape[:3] * np.exp(offsets), np.full(len(offsets), shape[3])])
    others, effort = fitted.columns.copy(), fitted.effort
    time = fitted.time
    edges = np.unique(np.searchsorted(time, np.arange(time[0], time[-1], STRETCH)))
    misfits = []
    for column in _columns(fitted, shapes).T:
        others[:, place] = column
        misfits.append(np.add.reduceat(cauchy(others, effort, SCALE * fitted.floor)[1], edges))
    rng = np.random.default_rng(0)
    drawn = rng.multinomial(edges.size, np.full(edges.size, 1.0 / edges.size), size=DRAWS)
    likeliest = offsets[np.argmin(np.stack(misfits) @ drawn.T, axis=0)]
    step = np.array([axis[1] - axis[0] for axis in AROUND])
    relative = likeliest.T @ likeliest / DRAWS + np.diag(step**2 / 12.0 + SHARED**2)
    return relative * np.outer(shape[:3], shape[:3])


def _columns(fitted: Fitted, shapes: Array) -> Array:
    """Columns (m, k) of many shapes, few at a time where the recording is long."""
    few = max(1, TOGETHER // max(fitted.time.size, 1))
    parts = [shapes[k : k + few] for k in range(0, len(shapes), few)]
    made = [fitted.seen(lambda signals, part=part: dead_zone_columns(signals, part), of_motion=True) for part in parts]
    return np.concatenate(made, axis=1)


def contacts_of(scope: Scope) -> list[float]:
    """Frequencies of contact that a search begins with - rad/s: one that swings faster than samples follow is rigid."""
    fastest = np.pi / scope.sample_period
    return sorted({min(contact, fastest) for contact in extended(CONTACTS, FREQUENCY.factor(scope))})


def _spring_rates(fitted: Fitted) -> set[float]:
    """Stiffness over load inertia of a spring on the load's side, 0 for none - 1/s**2: where a search begins."""
    stiffness, load = _stiffness(fitted, fitted.theta), fitted.base.inertia - fitted.scope.rotor_inertia
    return {0.0, max(stiffness, 0.0) / load} if load > 0.0 else {0.0}


def _stiffness(fitted: Fitted, theta: Array) -> float:
    return float(theta[fitted.places(Spring)].sum())


def _likely(fitted: Fitted, shape: Array, column: Array) -> Likely:
    theta, rows = cauchy(np.column_stack([fitted.columns, column]), fitted.effort, SCALE * fitted.floor)
    rate = float(shape[3])
    if rate > 0.0:
        stiffness = _stiffness(fitted, theta[:-1])
        rate = stiffness / float(theta[-1]) if theta[-1] > 0.0 and stiffness > 0.0 else rate
    return Likely(shape, float(rows.sum()), rate)


def cauchy(columns: Array, effort: Array, scale: float) -> tuple[Array, Array]:
    """Coefficients (p,) by reweighted least squares, and each row's negative logarithm of Cauchy's likelihood (m,)."""
    size = np.sqrt(np.mean(columns**2, axis=0)) + 1e-300
    columns = columns / size
    weight, left, theta = np.ones(effort.size), effort, np.zeros(size.size)
    for _ in range(REWEIGHTED):
        weighted = columns.T * weight
        theta = np.linalg.lstsq(weighted @ columns, weighted @ effort, rcond=1e-12)[0]
        left = effort - columns @ theta
        weight = 1.0 / (1.0 + (left / scale) ** 2)
    return theta / size, np.log1p((left / scale) ** 2)
