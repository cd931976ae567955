"""Torque constant drift: torque per ampere changes during the recording.

    M = M_reported*(1 + r*t)

r - relative rate - 1/s; t - time since the recording's start - s; M - torque that acts, M_reported = k_T*I by the rig's
torque constant - N*m (N). Magnets that warm lose about 0.1 % of it a kelvin, ferrites twice that; the gain of a warming
current sensor drifts alike, and a recording of motion cannot distinguish the two: it is the reading that no longer
represents the torque.
Source: T. Sebastian, Temperature effects on torque production and efficiency of PM motors using NdFeB magnets, IEEE
Transactions on Industry Applications 31(2), 1995.
"""

from bench.effects.effect import Stage
from bench.effects.shape import Shapes
from bench.effects.signals import Axis, AxisState, Number, Scope, Values
from bench.effects.torque import Torque
from bench.units import Quantity

#: Relative change over a recording at most: ferrite magnets that warm by 150 K. More passes for a torque of many waves.
MOST = 0.3


class TorqueConstantDrift(Torque):
    name = "torque_constant_drift"
    summary = "torque per ampere changes during the recording"
    stage = Stage.CURRENT_SENSOR
    copies_torque = True
    quantities = (Quantity("rate", "r", "1/s", null=0.0),)
    # of what changes at once at half time, t takes (3*T**2/8)**2/(T**3/3)/(T/2) = 27/32 of the squares, and a
    # compensation that is switched on is no drift
    needed = 0.85

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """What the rig's constant overstates."""
        return -values["rate"] * at.time * at.effort

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        return all(abs(rate) * scope.duration <= MOST for (rate,) in strengths)


EFFECT = TorqueConstantDrift()
