"""Friction warm-up: dry and viscous friction decay over time as the axis warms up.

    M = (K_0*sgn(omega) + K_w*omega)*(1 + A*exp(-t/T))

A - relative amplitude of the dry part, the viscous part may decay by another; T - time constant - s; t - time since the
recording's start - s.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.effects.effect import Base, Column, Effect, Shape, Signals
from bench.units import Quantity


class FrictionWarmup(Effect):
    """See the module."""

    name = "friction_warmup"
    summary = "friction decays over time as the axis warms up"
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0),
        Quantity("time_constant", "T", "s", lower=0.0),
    )
    shapes = (Shape(quantities[1], (0.7, 1.5, 3.0, 6.0, 12.0)),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """exp(-t/T) of the friction level, and of speed."""
        cold = np.exp(-signals.time / shape[0])
        return [[(signals.friction * cold, 0)], [(signals.velocity * cold, 0)]]

    def values(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Amplitude relative to the Coulomb friction of the warm axis."""
        return {"relative_amplitude": strengths[0] / base.coulomb, "time_constant": shape[0]}


EFFECT = FrictionWarmup()
