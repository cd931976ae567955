"""Current loop lag: torque acts later than the reported current.

    T*dM/dt + M = M_reported

T - time constant - s; M - torque that acts, M_reported = k_T*I of the reported current - N*m (N).
Source: D. Schröder, Elektrische Antriebe - Regelung von Antriebssystemen (closed current loop as a first-order lag).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.arrays import Array
from bench.effects.first_order import lagged
from bench.effects.grids import LAG
from bench.effects.kinds import Electronics, Values
from bench.effects.signals import Scope, Shape, Signals
from bench.statistics import NORMAL95
from bench.units import Quantity

#: Lags that a search tries first - s.
LAGS = (3e-4, 8e-4, 2e-3, 4e-3, 8e-3)


class CurrentLoopLag(Electronics):
    """See the module."""

    name = "current_loop_lag"
    summary = "torque acts later than the reported current"
    quantities = (Quantity("time_constant", "T", "s", lower=0.0, null=0.0),)
    shapes = (Shape(quantities[0], LAGS, reach=1.0, measure=LAG),)
    biased_by_noise = True
    not_beside = frozenset({"velocity_filter_lag", "current_filter_lag"})

    def see(self, signals: Signals, shape: Sequence[float]) -> Signals:
        """The torque that acts; what is made of it sees that."""
        return replace(signals, torque=lagged(signals.torque, shape[0], signals.sample_period))

    def delays(self, shape: Sequence[float], source: str) -> tuple[float, float]:
        """All columns, against the reported torque."""
        return shape[0], shape[0]

    def shape_errors(self, shape: Sequence[float], scope: Scope, time: Array) -> Sequence[float]:
        """By the tick within which current and speed were taken."""
        return [scope.latched / NORMAL95]

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """A lag of the speed, unless position tells that; and, as only the difference shows, one of the current."""
        separable = scope.source == "position" or {"position", "velocity"} <= scope.signals
        return () if separable else ("velocity_filter_lag", "current_filter_lag")

    def counterpart(self, name: str, values: Mapping[str, float]) -> Mapping[str, float] | None:
        """A lag of the speed by as much."""
        return {"time_constant": values["time_constant"]} if name == "velocity_filter_lag" else None

    def acting(self, values: Values, reported: Array, before: Array, step: float) -> tuple[Array, Array]:
        """Exact for a current that is held over the step."""
        half = np.exp(-0.5 * step / values["time_constant"])
        return reported + (before - reported) * half, reported + (before - reported) * half**2

    def acting_along(self, values: Mapping[str, float], reported: Array, step: float) -> Array:
        """Exact for a current that runs straight between the steps."""
        return lagged(reported, values["time_constant"], step)


EFFECT = CurrentLoopLag()
