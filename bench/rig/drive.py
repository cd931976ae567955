"""Drive of the axis: gains of its cascade, known so that the closed loop can be simulated."""

from __future__ import annotations

from bench.rig.values import Feedforward, IntegralGain, Rate, Table, Time, Viscous


class Drive(Table):
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
    control_period: Time = 250e-6
