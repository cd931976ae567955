"""Torque ripple: torque periodic in position and proportional to current, from windings that are not sinusoidal.

    M = M_motor*A*sin(n*q + phi)

A - relative amplitude; n - harmonic; M_motor = kT*Iq - N*m; q - angle - rad.
Source: D. C. Hanselman, Brushless Permanent Magnet Motor Design, 2nd ed., 2003, ch. 9.
"""

from collections.abc import Mapping, Sequence

from bench.arrays import Array
from bench.effects.acting import ScalesTorque
from bench.effects.signals import Axis, Base, Moment, Number, Signals, Values
from bench.effects.waves import PHASE, Harmonic, followed, harmonics, wave
from bench.trace.filter import Column
from bench.units import Quantity


class TorqueRipple(Harmonic, ScalesTorque):
    name = "torque_ripple"
    summary = "torque periodic in position, proportional to current"
    copies_torque = True
    repeatable = True
    shapes = (harmonics(1, 40),)
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, upper=1.0, null=0.0),
        shapes[0].quantity,
        PHASE,
    )

    def of_wave(self, signals: Signals, number: float, sine: Array, cosine: Array) -> list[Column]:
        """M*sin(n*q) and M*cos(n*q), nothing where the wave is faster than the samples can follow."""
        torque = signals.torque * followed(signals, number)
        return [[(torque * sine, 0)], [(torque * cosine, 0)]]

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """What resists is taken off the motor's torque, so the sign turns."""
        return super().report([-strength for strength in strengths], shape, base)

    def torque_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        return 1.0 + wave(values, "relative_amplitude", at.position)


EFFECT = TorqueRipple()
