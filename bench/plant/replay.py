"""Run a model that was written to disk along a recording."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError
from bench.plant.model_file import StoredModel
from bench.plant.track import BANDWIDTH, measured_velocity
from bench.plant.track_effects import track_effects
from bench.rig.rig import Rig
from bench.trace.trace import Trace

Array = NDArray[np.float64]


def replay_velocity(stored: StoredModel, trace: Trace, rig: Rig, bandwidth: float = BANDWIDTH) -> tuple[Array, Array]:
    """Measured and simulated velocity - rad/s (m/s) - (n,) each.

    Args:
        stored: the model.
        trace: the recording.
        rig: of its axis; turns what it recorded into torque (force).
        bandwidth: of the cascade that holds the model to the recording - rad/s.

    Raises:
        InputError: model and rig are of different kinds, or the rig gives no torque (force).
        SimulationError: the model diverged.
    """
    effort, unit = rig.net_effort(trace)
    if unit != rig.effort_unit:
        raise InputError(rig.source, f"gives the effort in {unit}", f"simulation needs {rig.effort_unit}")
    if stored.model.parameters.linear != rig.linear:
        raise InputError(rig.source, f"found a {rig.kind} axis", "allowed: one of the model's kind")
    return measured_velocity(trace), track_effects(stored.model, trace, effort, stored.misalignment, bandwidth)
