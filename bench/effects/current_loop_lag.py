"""Current loop lag: torque acts later than the reported current.

    T*dM/dt + M = M_reported

T - time constant - s; M - torque that acts, M_reported = k_T*I of the reported current - N*m (N).
Source: D. Schröder, Elektrische Antriebe - Regelung von Antriebssystemen (closed current loop as a first-order lag).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bench.arrays import Array, namespace
from bench.effects.acting import TorqueLag
from bench.effects.effect import Lag, lagged
from bench.effects.signals import Number, Scope, Signals, Values


class CurrentLoopLag(Lag, TorqueLag):
    name = "current_loop_lag"
    summary = "torque acts later than the reported current"
    signal = "torque"
    filters_motion = True

    def see(self, signals: Signals, shape: Sequence[float]) -> Signals:
        """The torque that acts; what is made of it sees that."""
        return replace(signals, torque=lagged(signals.torque, shape[0], signals.sample_period))

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """A lag of the speed, unless position tells that; and, as only the difference shows, one of the current."""
        separable = scope.source == "position" or {"position", "velocity"} <= scope.signals
        return () if separable else ("velocity_filter_lag", "current_filter_lag")

    def acting(self, values: Values, reported: Number, before: Number, step: float) -> tuple[Number, Number]:
        """Exact for a current that is held over the step."""
        passed = -0.5 * step / values["time_constant"]
        half = namespace(passed).exp(passed)
        return reported + (before - reported) * half, reported + (before - reported) * half**2

    def acting_along(self, values: Mapping[str, float], reported: Array, step: float) -> Array:
        """Exact for a current that runs straight between the steps."""
        return lagged(reported, values["time_constant"], step)


EFFECT = CurrentLoopLag()
