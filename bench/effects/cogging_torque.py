"""Cogging torque: periodic in position and independent of current, from magnets meeting teeth.

    M = A*sin(n*q + phi)

A - amplitude - N*m; n - harmonic, cycles per revolution, two or more; q - angle - rad.
Source: D. C. Hanselman, Brushless Permanent Magnet Motor Design, 2nd ed., 2003, ch. 5.
"""

from collections.abc import Mapping

from bench.effects.mjcf import Spec, passive_motor
from bench.effects.signals import Axis, AxisState, Number
from bench.effects.waves import PHASE, HarmonicTorque, harmonics
from bench.units import Quantity


class CoggingTorque(HarmonicTorque):
    name = "cogging_torque"
    summary = "torque periodic in position, independent of current"
    shapes = (harmonics(2, 80),)
    quantities = (Quantity("amplitude", "A", "N*m", lower=0.0, null=0.0), shapes[0].quantity, PHASE)

    def carrier(self, at: AxisState) -> Number:
        return 1.0

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A passive DC motor that cogs, whose sign is that of driving."""
        passive_motor(spec, name, cogging=(-values["amplitude"], values["harmonic"], values["phase"]))


EFFECT = CoggingTorque()
