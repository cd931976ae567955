"""Effort by an estimate along a motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, OFFSET, VISCOUS, AxisKind
from bench.fit.estimate import Estimate
from bench.trace.motion import Motion


def modelled_effort(motion: Motion, estimate: Estimate, kind: AxisKind) -> NDArray[np.float64]:
    """J*alpha + K_w*omega + K_0*sgn(omega) (+ M_0) - tau*dM/dt along a motion.

    Returns:
        (m,) - the effort's unit; nan where the direction is uncertain.
    """
    moving = motion.direction != 0.0
    columns = {
        INERTIA: motion.acceleration,
        VISCOUS: motion.velocity,
        COULOMB: motion.direction,
        OFFSET: np.ones(len(motion)),
        MISALIGNMENT: -motion.effort_rate,
    }
    found = {kind.parameter(term): column for term, column in columns.items()}
    modelled = sum((estimate.parameters[name].value * v for name, v in found.items() if name in estimate.parameters))
    return np.where(moving, modelled, np.nan)
