"""Search for a dead zone: the load is driven along the recorded motion for a grid of gaps and contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.candidates import gains
from bench.diagnose.hypothesis import BACKLASH, Fit, Hypothesis, Named, dead_zone_columns, fit, lags, prepared
from bench.diagnose.workbench import Workbench

Array = NDArray[np.float64]

#: Gaps in travel of the motor at the recording's RMS speed over one filter width; contacts - rad/s; dampings.
GAPS = tuple(float(g) for g in np.geomspace(0.03, 0.8, 8))
CONTACTS = tuple(2.0 * np.pi * f for f in (40.0, 70.0, 120.0, 200.0))
DAMPINGS = (0.2, 0.5, 1.0)
#: Factors around the best shape in each round of refinement: gap, frequency, damping.
SPREAD = (0.25, 0.3, 0.6)
ROUNDS = 5


def with_backlash(bench: Workbench, hypothesis: Hypothesis, spring_rate: float) -> Fit:
    """The hypothesis with the dead zone that explains most beside it.

    Args:
        bench: the recording.
        hypothesis: without backlash.
        spring_rate: stiffness over load inertia of a spring on the load's side, 0 for none - 1/s**2.
    """
    current = fit(bench, hypothesis)
    basis = current.span
    seen = prepared(bench, current.hypothesis)
    moving, _ = lags(bench, current.hypothesis)
    speed = float(np.sqrt(np.mean(bench.row_values(lambda s: s.velocity) ** 2)))
    scale = speed * bench.conditioning.filter.width
    axes = [np.array(GAPS) * scale, np.array(CONTACTS), np.array(DAMPINGS)]
    best = axes[0][:0]
    for level in range(ROUNDS):
        mesh = np.stack([m.ravel() for m in np.meshgrid(*axes, indexing="ij")], axis=1)
        shapes = np.column_stack([mesh, np.full(len(mesh), spring_rate)])
        columns = dead_zone_columns(seen, shapes, moving)
        best = shapes[int(np.argmax(gains(columns, 1, current.residual, basis)))]
        spread = np.array(SPREAD) * 0.5**level
        axes = [best[k] * np.exp(spread[k] * np.linspace(-1.0, 1.0, 5 if k == 0 else 3)) for k in range(3)]
    return fit(bench, current.hypothesis.with_effect(Named(BACKLASH, tuple(float(value) for value in best))))
