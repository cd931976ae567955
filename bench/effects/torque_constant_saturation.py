"""Saturation of the torque constant: torque per ampere falls at high current, beyond what the rig knows of it.

    M = kT*I*(1 - d*(I/I_peak)**2)

d - drop at peak current, 0 to 1; I_peak - peak current - A.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from bench.effects.effect import Base, Column, Effect, Signals
from bench.units import Quantity


class TorqueConstantSaturation(Effect):
    """See the module."""

    name = "torque_constant_saturation"
    summary = "torque per ampere falls at high current"
    quantities = (Quantity("drop_at_peak", "d", "dimensionless", lower=0.0, upper=1.0),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """M*(M/M_peak)**2: what the rig's constant overstates."""
        return [[(signals.effort * (signals.effort / signals.peak_effort) ** 2, 0)]]

    def values(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """The strength itself."""
        return {"drop_at_peak": strengths[0]}


EFFECT = TorqueConstantSaturation()
