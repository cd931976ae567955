"""Cases short enough for a test: an axis drawn at random along one quick run up and down."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.validation.independent.references import Motion, run_up_and_down
from bench.validation.plan import Case, any_axis


def short(index: int, rng: np.random.Generator) -> Case:
    """As `any_axis`, in less than a second."""
    case = any_axis(index, rng)
    axis = replace(case.axis, top_speed=0.25 * case.axis.top_speed)
    acceleration = 0.4 * axis.peak_torque / axis.inertia
    motion = Motion((run_up_and_down(axis.top_speed, acceleration, 0.05, 2, 0.01),))
    sensors = replace(case.sensors, sample_period=0.5e-3)
    return replace(case, axis=axis, motion=motion, motion_name="short", sensors=sensors)
