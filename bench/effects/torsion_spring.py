"""Torsion spring: a torque proportional to position (a hose, a cable).

    M = c*q

c - stiffness - N*m/rad (N/m), not negative; q - position - rad (m). A rest position other than zero is a torque offset.
"""

from collections.abc import Mapping, Sequence

from bench.effects.acting import AXIS, Native, Spec, Spring
from bench.effects.effect import OuterTorque
from bench.effects.signals import Axis, Moment, Number, Signals, Values
from bench.trace.filter import Column
from bench.units import Quantity


class TorsionSpring(OuterTorque, Spring, Native):
    name = "torsion_spring"
    summary = "a torque proportional to position"
    quantities = (Quantity("stiffness", "c", "N*m/rad", lower=0.0, null=0.0),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return [[(signals.position, 0)]]

    def load_torque(self, values: Values, at: Moment) -> Number:
        return values["stiffness"] * at.position

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        spec.joint(AXIS).stiffness[0] += values["stiffness"]


EFFECT = TorsionSpring()
