"""Cases short enough for a test: an axis drawn at random along one quick run up and down."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.validation.independent.references import Motion, run_up_and_down
from bench.validation.plan import AnyAxis, Case


@dataclass(frozen=True)
class Short:
    """As `AnyAxis`, in less than a second."""

    def plain(self, index: int, rng: np.random.Generator) -> Case:
        case = AnyAxis().plain(index, rng)
        axis = replace(case.axis, top_speed=0.25 * case.axis.top_speed)
        acceleration = 0.4 * axis.peak_torque / axis.inertia
        motion = Motion((run_up_and_down(axis.top_speed, acceleration, 0.05, 2, 0.01),))
        sensors = replace(case.sensors, sample_period=0.5e-3)
        return replace(case, axis=axis, motion=motion, motion_name="short", sensors=sensors)
