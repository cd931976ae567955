"""Position-dependent friction: the level of dry friction varies once per revolution (a bent screw, a worn spot).

    M = K_0*(1 + A*sin(q + phi))*sgn(omega)

A - relative amplitude; q - angle - rad.
"""

from bench.effects.signals import Axis, AxisState, Number, Values
from bench.effects.torque import Friction
from bench.effects.waves import PHASE, Wave
from bench.units import Quantity


class PositionDependentFriction(Wave, Friction):
    name = "position_dependent_friction"
    summary = "friction level varies with position"
    scales_friction = True
    quantities = (Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, upper=1.5, null=0.0), PHASE)

    def unit(self, base: Axis) -> float:
        return base.coulomb

    def friction(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return at.friction * self.wave(values, at.position)


EFFECT = PositionDependentFriction()
