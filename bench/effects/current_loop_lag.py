"""Current loop lag: torque acts later than the reported current.

    T*dM/dt + M = M_reported

T - time constant - s; M - torque that acts, M_reported = k_T*I of the reported current - N*m (N).
Source: D. Schröder, Elektrische Antriebe - Regelung von Antriebssystemen (closed current loop as a first-order lag).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.signal import lfilter

from bench.effects.physics import Array, Axis, Electronics, Number, Values
from bench.units import Quantity


class CurrentLoopLag(Electronics):
    """See the module."""

    name = "current_loop_lag"
    summary = "torque acts later than the reported current"
    quantities = (Quantity("time_constant", "T", "s", lower=0.0),)

    def null(self, axis: Axis) -> Mapping[str, Number]:
        """Where the effect is absent."""
        return {"time_constant": 0.0}

    def acting(self, values: Values, reported: Array, before: Array, step: float) -> tuple[Array, Array]:
        """Exact for a current that is held over the step."""
        half = np.exp(-0.5 * step / values["time_constant"])
        return reported + (before - reported) * half, reported + (before - reported) * half**2

    def acting_along(self, values: Mapping[str, float], reported: Array, step: float) -> Array:
        """The same, started in equilibrium."""
        half = np.exp(-0.5 * step / values["time_constant"])
        decay = half**2
        ends, _ = lfilter([1.0 - decay], [1.0, -decay], reported, zi=[decay * reported[0]])
        before = np.concatenate([reported[:1], ends[:-1]])
        return reported + (before - reported) * half


EFFECT = CurrentLoopLag()
