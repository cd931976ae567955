"""Torque offset: a constant torque (a weight, a counterbalance, a bias of the current measurement).

    M = M_0

M_0 - N*m (N).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.effects.acting import ConstantTorque, Native, Spec, add_resisting_torque
from bench.effects.signals import Axis, Moment, Number, Scope, Signals, Values
from bench.trace.filter import Column
from bench.units import Quantity


class TorqueOffset(ConstantTorque, Native):
    name = "torque_offset"
    summary = "a constant torque"
    quantities = (Quantity("torque", "M_0", "N*m", null=0.0),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return [[(np.ones_like(signals.time), 0)]]

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """Friction that differs between the directions by a constant, wherever the axis moves."""
        return ("direction_dependent_friction",)

    def load_torque(self, values: Values, at: Moment) -> Number:
        return values["torque"]

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Part of the load's constant torque."""
        add_resisting_torque(spec, values["torque"])


EFFECT = TorqueOffset()
