"""Position-dependent friction: the level of dry friction varies once per revolution (a bent screw, a worn spot).

    M = K_0*(1 + A*sin(q + phi))*sgn(omega)

A - relative amplitude; q - angle - rad.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.arrays import namespace
from bench.effects.acting import ScalesFriction
from bench.effects.axis import Axis, Moment, Number, Values
from bench.effects.effect import OncePerRevolution
from bench.effects.signals import Base, Signals
from bench.effects.waves import amplitude_and_phase
from bench.trace.filter import Column
from bench.units import Quantity


class PositionDependentFriction(OncePerRevolution, ScalesFriction):
    """See the module."""

    name = "position_dependent_friction"
    summary = "friction level varies with position"
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, upper=1.5, null=0.0),
        Quantity("phase", "phi", "rad", angle=True, preset=0.0),
    )

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """sin(q) and cos(q) of the friction level."""
        return [[(signals.friction * wave, 0)] for wave in (np.sin(signals.position), np.cos(signals.position))]

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Amplitude relative to Coulomb friction, and phase."""
        amplitude, phase = amplitude_and_phase(*strengths)
        return {"relative_amplitude": amplitude / base.coulomb, "phase": phase}

    def friction_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Once up and down a revolution."""
        angle = at.position + values["phase"]
        return 1.0 + values["relative_amplitude"] * namespace(angle).sin(angle)


EFFECT = PositionDependentFriction()
