"""Effort that an estimate explains along a motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.axis_kind import AxisKind
from bench.identify.estimate import Estimate
from bench.identify.regressors import regressors
from bench.trace.motion import Motion


def modelled_effort(motion: Motion, estimate: Estimate, kind: AxisKind) -> NDArray[np.float64]:
    """J*alpha + K_w*omega + K_0*sgn(omega) (+ M_0) along a motion.

    Returns:
        (m,) - the effort's unit; nan where the direction is in doubt.
    """
    rows = regressors(motion)
    names = [kind.parameter(column) for column in rows.names]
    theta = np.array([estimate.parameters[name].value if name in estimate.parameters else 0.0 for name in names])
    modelled = np.full(len(motion), np.nan)
    modelled[motion.direction != 0.0] = rows.columns @ theta
    return modelled
