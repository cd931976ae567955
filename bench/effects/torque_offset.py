"""Torque offset: a constant torque (a weight, a counterbalance, a bias of the current measurement).

    M = M_0

M_0 - N*m (N).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from bench.effects.effect import Base, Column, Effect, Signals
from bench.effects.mjcf import add_resisting_torque
from bench.effects.physics import Axis, Mechanism, Number
from bench.units import Quantity


class TorqueOffset(Mechanism, Effect):
    """See the module."""

    name = "torque_offset"
    summary = "a constant torque"
    quantities = (Quantity("torque", "M_0", "N*m"),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """One."""
        return [[(np.ones_like(signals.time), 0)]]

    def values(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """The strength itself."""
        return {"torque": strengths[0]}

    def null(self, axis: Axis) -> Mapping[str, Number]:
        """Where the effect is absent."""
        return {"torque": 0.0}

    def add(self, spec: mujoco.MjSpec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Part of the load's constant torque."""
        add_resisting_torque(spec, values["torque"])


EFFECT = TorqueOffset()
