"""Current loop lag: torque acts later than the reported current.

    T*dM/dt + M = M_reported

T - time constant - s; M - torque that acts, M_reported = k_T*I of the reported current - N*m (N).
Source: D. Schröder, Elektrische Antriebe - Regelung von Antriebssystemen (closed current loop as a first-order lag).
"""

from bench.effects.effect import Lag, Stage
from bench.effects.signals import Scope


class CurrentLoopLag(Lag):
    name = "current_loop_lag"
    summary = "torque acts later than the reported current"
    signal = "torque"
    stage = Stage.CURRENT_LOOP
    filters_motion = True

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """A lag of the speed, unless position determines that; and one of the current, as only the difference shows."""
        separable = scope.source == "position" or {"position", "velocity"} <= scope.signals
        return () if separable else ("velocity_filter_lag", "current_filter_lag")


EFFECT = CurrentLoopLag()
