"""Load torque event: an external torque acts for a stretch of time (a collision, a hand, a brake dragging).

    M = M_e for t_1 <= t < t_2, else 0

M_e - N*m (N); t - time since the recording's start - s.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.effects.effect import Base, Column, Effect, Shape, Signals
from bench.effects.physics import Axis, Mechanism, Moment, Number, Values
from bench.units import Quantity


class LoadTorqueEvent(Mechanism, Effect):
    """See the module."""

    name = "load_torque_event"
    summary = "an external torque acts for a stretch of time"
    quantities = (
        Quantity("torque", "M_e", "N*m"),
        Quantity("start", "t_1", "s", lower=0.0),
        Quantity("end", "t_2", "s", lower=0.0),
    )
    may_load = True
    shapes = (Shape(quantities[1], ()), Shape(quantities[2], ()))

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """One within the stretch; its edges shared between the samples around them."""
        start, end = ((signals.time - edge) / signals.sample_period + 0.5 for edge in shape)
        return [[(np.clip(start, 0.0, 1.0) - np.clip(end, 0.0, 1.0), 0)]]

    def values(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Torque and stretch."""
        return {"torque": strengths[0], "start": shape[0], "end": shape[1]}

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> bool:
        """It ends after it starts."""
        return shape[1] > shape[0]

    def null(self, axis: Axis) -> Mapping[str, Number]:
        """Where the effect is absent."""
        return {"torque": 0.0}

    def resisting_torque(self, values: Values, axis: Axis, at: Moment) -> Number:
        """While it acts."""
        acts = np.asarray((at.time >= values["start"]) & (at.time < values["end"]), dtype=np.float64)
        return values["torque"] * acts


EFFECT = LoadTorqueEvent()
