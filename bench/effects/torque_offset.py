"""Torque offset: a constant torque (a weight, a counterbalance, a bias of the current measurement).

    M = M_0

M_0 - N*m (N).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.effects.effect import Base, Column, Effect, Signals
from bench.units import Quantity


class TorqueOffset(Effect):
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


EFFECT = TorqueOffset()
