"""Direction-dependent friction: dry and viscous friction differ between the two directions.

    M = K_w*omega + K_0*sgn(omega) + D_0/2 + D_w/2*|omega|

D_0, D_w - Coulomb and viscous friction forward less backward - N*m (N), N*m*s/rad (N*s/m). The constant part cannot be
distinguished from a torque offset by any recording: they are each other's `ambiguous_with`.
Source: A. Janot, M. Gautier, M. Brunot, NSIB workshop 2019 (EMPS, asymmetric friction).
"""

from collections.abc import Mapping, Sequence

from bench.effects.mjcf import AXIS, Spec, add_resisting_torque
from bench.effects.signals import Axis, AxisState, Number, Scope, Values
from bench.effects.torque import Friction
from bench.units import Quantity


class DirectionDependentFriction(Friction):
    name = "direction_dependent_friction"
    summary = "friction differs between the two directions"
    of_speed = True
    directed = True
    quantities = (
        Quantity("coulomb_difference", "D_0", "N*m", null=0.0),
        Quantity("viscous_difference", "D_w", "N*m*s/rad", null=0.0, preset=0.0),
    )

    def friction(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return 0.5 * at.direction * values["coulomb_difference"]

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """Half of the viscous difference, in either direction."""
        return 0.5 * values["viscous_difference"] * abs(at.velocity)

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> bool:
        """Dry friction resists in both directions: more of a difference is a torque that drives."""
        return abs(strengths[0]) <= 2.0 * base.coulomb

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """A constant torque, wherever the axis moves."""
        return ("torque_offset",)

    def native(self, values: Mapping[str, float], friction_varies: bool) -> bool:
        """Dry friction alone is native: half of the difference is a constant torque, at rest and in motion."""
        return values["viscous_difference"] == 0.0 and not friction_varies

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Half of the remainder of the two levels as friction of the joint, half of their difference as torque."""
        level, half = float(axis.coulomb), 0.5 * values["coulomb_difference"]
        forward, backward = max(level + half, 0.0), max(level - half, 0.0)
        spec.joint(AXIS).frictionloss = 0.5 * (forward + backward)
        add_resisting_torque(spec, 0.5 * (forward - backward))


EFFECT = DirectionDependentFriction()
