"""Torque ripple: torque periodic in position and proportional to current, from windings that are not sinusoidal.

    M = M_motor*A*sin(n*q + phi)

A - relative amplitude; n - harmonic; M_motor = kT*Iq - N*m; q - angle - rad.
Source: D. C. Hanselman, Brushless Permanent Magnet Motor Design, 2nd ed., 2003, ch. 9.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.arrays import namespace
from bench.effects.acting import ScalesTorque
from bench.effects.axis import Axis, Moment, Number, Values
from bench.effects.effect import CopiesTorque, Repeatable, Wave
from bench.effects.signals import Base, Shape, Signals
from bench.effects.waves import amplitude_and_phase, followed
from bench.trace.filter import Column
from bench.units import Quantity


class TorqueRipple(Wave, CopiesTorque, Repeatable, ScalesTorque):
    """See the module."""

    name = "torque_ripple"
    summary = "torque periodic in position, proportional to current"
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, upper=1.0, null=0.0),
        Quantity("harmonic", "n", "dimensionless", lower=1.0, linear_unit="rad/m"),
        Quantity("phase", "phi", "rad", angle=True, preset=0.0),
    )
    shapes = (Shape(quantities[1], tuple(float(n) for n in range(1, 41)), whole=True),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """M*sin(n*q) and M*cos(n*q), nothing where the wave is faster than the samples can follow."""
        angle, torque = shape[0] * signals.position, signals.torque * followed(signals, shape[0])
        return [[(torque * np.sin(angle), 0)], [(torque * np.cos(angle), 0)]]

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Amplitude, harmonic and phase; what resists is taken off the motor's torque, so the sign turns."""
        amplitude, phase = amplitude_and_phase(-strengths[0], -strengths[1])
        return {"relative_amplitude": amplitude, "harmonic": shape[0], "phase": phase}

    def torque_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Of the angle the motor is at."""
        angle = values["harmonic"] * at.position + values["phase"]
        return 1.0 + values["relative_amplitude"] * namespace(angle).sin(angle)


EFFECT = TorqueRipple()
