"""Position-dependent friction: the level of dry friction varies once per revolution (a bent screw, a worn spot).

    M = K_0*(1 + A*sin(q + phi))*sgn(omega)

A - relative amplitude; q - angle - rad.
"""

from collections.abc import Sequence

from bench.effects.acting import ScalesFriction
from bench.effects.signals import Axis, Base, Moment, Number, Signals, Values
from bench.effects.waves import PHASE, OncePerRevolution, once_per_revolution, wave
from bench.trace.filter import Column
from bench.units import Quantity


class PositionDependentFriction(OncePerRevolution, ScalesFriction):
    name = "position_dependent_friction"
    summary = "friction level varies with position"
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, upper=1.5, null=0.0),
        PHASE,
    )

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return once_per_revolution(signals.position, signals.friction)

    def unit(self, base: Base) -> float:
        return base.coulomb

    def friction_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        return 1.0 + wave(values, "relative_amplitude", at.position)


EFFECT = PositionDependentFriction()
