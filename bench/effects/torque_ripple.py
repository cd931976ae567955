"""Torque ripple: torque periodic in position and proportional to current, from windings that are not sinusoidal.

    M = M_motor*A*sin(n*q + phi)

A - relative amplitude; n - harmonic; M_motor = kT*Iq - N*m; q - angle - rad.
Source: D. C. Hanselman, Brushless Permanent Magnet Motor Design, 2nd ed., 2003, ch. 9.
"""

from bench.effects.effect import Stage
from bench.effects.signals import AxisState, Number
from bench.effects.waves import PHASE, HarmonicTorque, harmonics
from bench.units import Quantity


class TorqueRipple(HarmonicTorque):
    name = "torque_ripple"
    summary = "torque periodic in position, proportional to current"
    stage = Stage.COMMUTATION
    copies_torque = True
    shapes = (harmonics(1, 40),)
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, upper=1.0, null=0.0),
        shapes[0].quantity,
        PHASE,
    )

    def carrier(self, at: AxisState) -> Number:
        """The motor's torque, which a positive wave adds to."""
        return -at.effort


EFFECT = TorqueRipple()
