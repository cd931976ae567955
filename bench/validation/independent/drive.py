"""The contract's drive, for many axes at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.validation.independent.rig import Axis


class Drive:
    """torque = K_v*e_v + K_i*integral(e_v dt) + J_ff*alpha_ref, e_v = w_ref + K_p*(q_ref - q) - w.

    Current is limited to its peak, the integrator held while limited; one command each control period.
    """

    def __init__(self, axes: Sequence[Axis], control_period: float) -> None:
        def array(name: str) -> np.ndarray:
            return np.array([getattr(axis, name) for axis in axes])

        self._kp, self._kv, self._ki = array("position_gain"), array("velocity_gain"), array("integral_gain")
        self._jff, self._kt, self._peak = array("inertia_feedforward"), array("torque_constant"), array("peak_current")
        self._period, self._integral = control_period, np.zeros(len(axes))

    def current(self, reference: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Current demand - A - from q_ref, w_ref, alpha_ref (3, n) and measurements - (n,) each."""
        q, w, alpha = reference
        error = w + self._kp * (q - position) - velocity
        torque = self._kv * error + self._ki * self._integral + self._jff * alpha
        demand = torque / self._kt
        free = np.abs(demand) < self._peak
        self._integral += self._period * error * free
        return np.where(free, demand, np.sign(demand) * self._peak)
