"""Search for a dead zone: the load is driven along the recorded motion for a grid of gaps and contacts.

Impacts are short and hard, and the instant of one hangs on how the load left the other side of the gap: a few rows are
far off whatever the shape. So shapes are compared by Cauchy's likelihood, sum(log(1 + (r/s)**2)), which lets them be.
Source: P. J. Huber, E. M. Ronchetti, Robust Statistics, 2nd ed., 2009, ch. 7.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.columns import lags, prepared
from bench.diagnose.dead_zone import dead_zone_columns
from bench.diagnose.fit import Fit, fit
from bench.diagnose.hypothesis import BACKLASH, SPRING, Hypothesis, Named
from bench.diagnose.workbench import Workbench

Array = NDArray[np.float64]

#: Gaps in travel of the motor at the recording's RMS speed over one filter width; contacts - rad/s; damping ratio.
GAPS = tuple(float(g) for g in np.geomspace(0.03, 0.8, 16))
CONTACTS = tuple(2.0 * np.pi * f for f in (40.0, 80.0, 130.0, 210.0))
DAMPING = 0.4
#: Offsets around a shape in each round of refinement - gap, frequency, damping - and their size at first, as factor
#: e**offset. Refinement starts from the likeliest shapes of several contacts, and ends with the likeliest of all.
OFFSETS = np.stack([m.ravel() for m in np.meshgrid(np.linspace(-1, 1, 5), [-1, 0, 1], [-1, 0, 1], indexing="ij")], 1)
SPREAD = (0.12, 0.4, 0.5)
ROUNDS, STARTS, ALL_STARTS = 6, 3, 2
#: Residual in noise floors beyond which a row counts less and less, and reweightings of the least squares.
SCALE, REWEIGHTED = 3.0, 6


def with_backlash(bench: Workbench, hypothesis: Hypothesis, spring_rates: set[float]) -> Fit:
    """The hypothesis with the likeliest dead zone beside it.

    Args:
        bench: the recording.
        hypothesis: without backlash.
        spring_rates: stiffnesses over load inertia of a spring on the load's side, 0 for none - 1/s**2; another than 0
            is only where a search begins.
    """
    current = fit(bench, hypothesis)
    seen = prepared(bench, current.hypothesis)
    moving, _ = lags(bench, current.hypothesis)
    speed = float(np.sqrt(np.mean(bench.row_values(lambda s: s.velocity) ** 2)))
    scale = speed * bench.conditioning.filter.width

    def likeliest(shapes: Array) -> list[Likely]:
        columns = dead_zone_columns(seen, shapes, moving)
        found = (_likely(current, shape, column) for shape, column in zip(shapes, columns.T, strict=True))
        return sorted(found, key=lambda likely: likely.misfit)

    axes = [np.array(GAPS) * scale, np.array(CONTACTS), np.array([DAMPING]), np.array(sorted(spring_rates))]
    tried = likeliest(np.stack([m.ravel() for m in np.meshgrid(*axes, indexing="ij")], axis=1))
    starts = [next(found for found in tried if found.shape[1] == contact) for contact in CONTACTS]
    starts = sorted(starts, key=lambda likely: likely.misfit)[:STARTS]
    for level in range(1, ROUNDS):
        offsets = np.exp(OFFSETS * np.array(SPREAD) * 0.6 ** (level - 1))
        around = np.concatenate([_around(start, offsets) for start in starts])
        tried, size = likeliest(around), len(offsets)
        groups = [{row.tobytes() for row in around[k * size : (k + 1) * size]} for k in range(len(starts))]
        refined = [next(found for found in tried if found.shape.tobytes() in group) for group in groups]
        starts = [min(pair, key=lambda likely: likely.misfit) for pair in zip(starts, refined, strict=True)]
        starts = sorted(starts, key=lambda likely: likely.misfit)[: STARTS if level < ALL_STARTS else 1]
    shape = tuple(float(value) for value in starts[0].shape)
    return fit(bench, current.hypothesis.with_effect(Named(BACKLASH, shape)))


@dataclass(frozen=True)
class Likely:
    """A dead zone's shape (4,), its negative logarithm of likelihood, and the load's spring rate that comes of it."""

    shape: Array
    misfit: float
    spring_rate: float


def _around(start: Likely, factors: Array) -> Array:
    """Shapes (k, 4) around one, with the spring that was found beside it."""
    return np.column_stack([start.shape[:3] * factors, np.full(len(factors), start.spring_rate)])


def _likely(current: Fit, shape: Array, column: Array) -> Likely:
    columns = np.column_stack([current.columns, column])
    theta, rows = cauchy(columns, current.residual + current.columns @ current.theta, SCALE * current.floor)
    rate = float(shape[3])
    if rate > 0.0:
        stiffness = float(theta[:-1][current.owners == current.hypothesis.names.index(SPRING)][0])
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
