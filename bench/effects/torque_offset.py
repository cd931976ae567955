"""Torque offset: a constant torque (a weight, a counterbalance, a bias of the current measurement).

    M = M_0

M_0 - N*m (N).
"""

from collections.abc import Mapping

from bench.effects.mjcf import Spec, add_resisting_torque
from bench.effects.signals import Axis, AxisState, Number, Scope, Values
from bench.effects.torque import Torque
from bench.units import Quantity


class TorqueOffset(Torque):
    name = "torque_offset"
    summary = "a constant torque"
    transmitted = True
    constant = True
    quantities = (Quantity("torque", "M_0", "N*m", null=0.0),)
    looks_like = ("current_offset_drift",)  # with r = 3*M_0/(2*T): all but a quarter of the squares over a time T

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return values["torque"]

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """Friction that differs between the directions by a constant, wherever the axis moves."""
        return ("direction_dependent_friction",)

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Part of the load's constant torque."""
        add_resisting_torque(spec, values["torque"])


EFFECT = TorqueOffset()
