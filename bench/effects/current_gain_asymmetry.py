"""Current gain asymmetry: amperes per reading differ between positive and negative current.

    M = M_reported*(1 + d/2*sgn(M_reported))

d - gain of positive less that of negative current, over their mean; M - torque that acts, M_reported = k_T*I of the
reported current - N*m (N). Two amplifiers or two half-bridge shunts, one for each sign, make it; the drive, too,
believes the reading.
Source: D.-W. Chung, S.-K. Sul, Analysis and compensation of current measurement error in vector-controlled AC motor
drives, IEEE Transactions on Industry Applications 34(2), 1998 (scaling errors of current sensors).
"""

from bench.effects.effect import Stage
from bench.effects.shape import Shapes
from bench.effects.signals import Axis, AxisState, Number, Scope, Values
from bench.effects.torque import Torque
from bench.units import Quantity

#: Of what two shunts of 5 % make: more, such as what a torque of many waves imitates in one direction, is no sensor's.
MOST = 0.1


class CurrentGainAsymmetry(Torque):
    name = "current_gain_asymmetry"
    summary = "amperes per reading differ between positive and negative current"
    stage = Stage.CURRENT_SENSOR
    copies_torque = True
    quantities = (Quantity("gain_difference", "d", "dimensionless", lower=-1.0, upper=1.0, null=0.0),)

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """What readings of positive current lack, and those of negative have too much."""
        return -0.5 * values["gain_difference"] * abs(at.effort)

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        return all(abs(difference) <= MOST for (difference,) in strengths)


EFFECT = CurrentGainAsymmetry()
