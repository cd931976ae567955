"""Quadratic drag: resisting torque grows with velocity times its magnitude (a fan, a fluid).

    M = k_q*omega*|omega|

k_q - N*m*s**2/rad**2 (N*s**2/m**2), not negative.
"""

from collections.abc import Mapping

from bench.effects.mjcf import AXIS, Spec
from bench.effects.signals import Axis, AxisState, Number, Values
from bench.effects.torque import Torque
from bench.units import Quantity


class QuadraticDrag(Torque):
    name = "quadratic_drag"
    summary = "resisting torque grows with velocity*|velocity|"
    of_speed = True
    external = True
    quantities = (Quantity("quadratic_drag", "k_q", "N*m*s**2/rad**2", lower=0.0, null=0.0),)

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return values["quadratic_drag"] * at.velocity * abs(at.velocity)

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Second coefficient of the joint's damping, which grows with speed."""
        spec.joint(AXIS).damping[1] += values["quadratic_drag"]


EFFECT = QuadraticDrag()
