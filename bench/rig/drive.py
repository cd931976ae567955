"""Drive of the axis: gains of its cascade, known so that the closed loop can be simulated."""

from __future__ import annotations

import math

from pydantic import model_validator

from bench.rig.values import Feedforward, IntegralGain, Period, Rate, RigTable, Viscous


class Drive(RigTable):
    """Cascade of a position P controller and a velocity PI controller with inertia feed-forward.

    torque = velocity_gain*e_v + integral_gain*integral(e_v dt) + inertia_feedforward*acceleration_reference,
    e_v = velocity_reference + position_gain*(position_reference - position) - velocity; current limited to the motor's
    peak current, the integrator held while limited.

    Attributes:
        position_gain: velocity demand per position error - 1/s.
        velocity_gain: torque per velocity error - N*m*s/rad (N*s/m on a linear axis).
        integral_gain: torque per integrated velocity error - N*m/rad (N/m).
        inertia_feedforward: torque per acceleration reference - kg*m**2 (kg).
        control_period: of the loop - s.
    """

    position_gain: Rate
    velocity_gain: Viscous
    integral_gain: IntegralGain = 0.0
    inertia_feedforward: Feedforward = 0.0
    control_period: Period = 250e-6

    @model_validator(mode="after")
    def _samples_fast_enough(self) -> Drive:
        """Half a period T of delay takes (K_v*K_p + K_i)*T/2 off the velocity gain K_v, and must leave some of it."""
        stiffness = self.velocity_gain * self.position_gain + self.integral_gain
        most = 2.0 * self.velocity_gain / stiffness if stiffness > 0.0 else math.inf
        if self.control_period > most:
            found = f"found {self.control_period:g} s"
            raise ValueError(f"control_period must be below {most:.3g} s with these gains, {found}")
        return self
