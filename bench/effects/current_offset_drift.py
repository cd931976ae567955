"""Current offset drift: the zero of the current sensor drifts during the recording.

    M = M_reported - r*t

r - rate - N*m/s (N/s); t - time since the recording's start - s; M - torque that acts, M_reported = k_T*I of the
reported current - N*m (N). The zero at the start is a constant torque, which `torque_offset` is; the drive, too,
believes the reading. In one direction of motion a drifting zero is no other than friction that warms up, and is not
sought.
Source: D.-W. Chung, S.-K. Sul, Analysis and compensation of current measurement error in vector-controlled AC motor
drives, IEEE Transactions on Industry Applications 34(2), 1998 (offset errors of current sensors).
"""

from bench.effects.effect import Stage
from bench.effects.signals import Axis, AxisState, Number, Scope, Values
from bench.effects.torque import Torque
from bench.units import Quantity


class CurrentOffsetDrift(Torque):
    name = "current_offset_drift"
    summary = "the zero of the current sensor drifts during the recording"
    stage = Stage.CURRENT_SENSOR
    quantities = (Quantity("rate", "r", "N*m/s", null=0.0),)
    looks_like = ("torque_offset",)
    needed = 0.8  # more than a constant torque gives it: of the squares of one, r*t takes (T**2/2)**2/(T**3/3)/T = 3/4

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return values["rate"] * at.time

    def sought(self, scope: Scope) -> bool:
        return not scope.one_way


EFFECT = CurrentOffsetDrift()
