"""Stribeck friction: dry friction rises as speed falls towards zero.

    M = K_0*sgn(omega) + (M_s - K_0)*exp(-(omega/omega_s)**2)*sgn(omega)

M_s - static friction - N*m (N); omega_s - Stribeck velocity - rad/s (m/s); K_0 - Coulomb friction.
Source: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30(7), 1994, eq. 4.
"""

from collections.abc import Mapping, Sequence

from bench.arrays import namespace
from bench.effects.shape import SPEED, Shape, Shapes
from bench.effects.signals import Axis, AxisState, Number, Scope, Values
from bench.effects.torque import Friction, FrictionLaw
from bench.units import Quantity

#: Share of the highest speed within which a rise ends: 0.06 of true ones, 0.20 to 0.29 of a drag without its name.
RISE = 0.2


class StribeckFriction(Friction):
    name = "stribeck_friction"
    summary = "friction rises as speed falls towards zero"
    of_speed = True
    quantities = (
        Quantity("static_friction", "M_s", "N*m", lower=0.0),
        Quantity("stribeck_velocity", "omega_s", "rad/s", lower=0.0),
    )
    shapes = (Shape(quantities[1], (0.3, 0.6, 1.2, 2.5, 5.0, 10.0, 20.0), measure=SPEED),)

    def friction(self, values: Values, axis: Axis, at: AxisState) -> Number:
        fallen = -((at.velocity / values["stribeck_velocity"]) ** 2)
        return (values["static_friction"] - axis.coulomb) * namespace(fallen).exp(fallen)

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        """Static friction is Coulomb friction plus the rise."""
        return {"static_friction": base.coulomb + strengths[0], "stribeck_velocity": shape[0]}

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> bool:
        """Friction rises towards standstill, and dry friction stays positive."""
        return strengths[0] > 0.0 and base.coulomb > 0.0

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        """The rise ends within a share of the speeds."""
        return all(speed <= RISE * scope.top_speed for (speed,) in shapes)

    def null(self, axis: Axis) -> Mapping[str, Number]:
        return {"static_friction": axis.coulomb}

    least = null  # friction that falls towards standstill would drive the axis on

    def law(self, values: Mapping[str, float], axis: Axis) -> FrictionLaw:
        return FrictionLaw(values["static_friction"] - float(axis.coulomb), values["stribeck_velocity"])


EFFECT = StribeckFriction()
