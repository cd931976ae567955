"""Search for a dead zone: the load is driven along the recorded motion for a grid of gaps and contacts.

Impacts are short and hard, and the instant of one hangs on how the load left the other side of the gap: a few rows are
far off whatever the shape. So shapes are compared by Cauchy's likelihood, sum(log(1 + (r/s)**2)), which lets them be.
Source: P. J. Huber, E. M. Ronchetti, Robust Statistics, 2nd ed., 2009, ch. 7.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.columns import lags, prepared
from bench.diagnose.dead_zone import dead_zone_columns
from bench.diagnose.fit import Fit, fit
from bench.diagnose.hypothesis import BACKLASH, Hypothesis, Named
from bench.diagnose.workbench import Workbench

Array = NDArray[np.float64]

#: Gaps in travel of the motor at the recording's RMS speed over one filter width; contacts - rad/s; dampings.
GAPS = tuple(float(g) for g in np.geomspace(0.03, 0.8, 16))
CONTACTS = tuple(2.0 * np.pi * f for f in (40.0, 80.0, 160.0))
DAMPINGS = (0.3, 0.7)
#: Factors around the best shape in each round of refinement: gap, frequency, damping.
SPREAD = (0.12, 0.4, 0.5)
ROUNDS = 6
#: Residual in noise floors beyond which a row counts less and less, and reweightings of the least squares.
SCALE, REWEIGHTED = 3.0, 6


def with_backlash(bench: Workbench, hypothesis: Hypothesis, spring_rates: set[float]) -> Fit:
    """The hypothesis with the likeliest dead zone beside it.

    Args:
        bench: the recording.
        hypothesis: without backlash.
        spring_rates: stiffnesses over load inertia of a spring on the load's side, 0 for none - 1/s**2.
    """
    current = fit(bench, hypothesis)
    seen = prepared(bench, current.hypothesis)
    moving, _ = lags(bench, current.hypothesis)
    speed = float(np.sqrt(np.mean(bench.row_values(lambda s: s.velocity) ** 2)))
    scale = speed * bench.conditioning.filter.width
    axes = [np.array(GAPS) * scale, np.array(CONTACTS), np.array(DAMPINGS), np.array(sorted(spring_rates))]
    best, likely = np.empty(0), np.inf
    for level in range(ROUNDS):
        shapes = np.stack([m.ravel() for m in np.meshgrid(*axes, indexing="ij")], axis=1)
        columns = dead_zone_columns(seen, shapes, moving)
        found = [_misfit(current, column, SCALE * current.floor) for column in columns.T]
        if min(found) < likely:
            best, likely = shapes[int(np.argmin(found))], min(found)
        spread = np.array(SPREAD) * 0.6**level
        axes = [best[k] * np.exp(spread[k] * np.linspace(-1.0, 1.0, 5 if k == 0 else 3)) for k in range(3)]
        axes.append(best[3:])
    return fit(bench, current.hypothesis.with_effect(Named(BACKLASH, tuple(float(value) for value in best))))


def _misfit(current: Fit, column: Array, scale: float) -> float:
    """Negative logarithm of Cauchy's likelihood of a fit and one column beside it, by reweighted least squares."""
    columns = np.column_stack([current.columns, column])
    columns = columns / (np.sqrt(np.mean(columns**2, axis=0)) + 1e-300)
    effort = current.residual + current.columns @ current.theta
    weight, left = np.ones(effort.size), effort
    for _ in range(REWEIGHTED):
        weighted = columns.T * weight
        theta = np.linalg.lstsq(weighted @ columns, weighted @ effort, rcond=1e-12)[0]
        left = effort - columns @ theta
        weight = 1.0 / (1.0 + (left / scale) ** 2)
    return float(np.sum(np.log1p((left / scale) ** 2)))
