"""Unbalance: an eccentric mass under gravity, once per revolution.

    M = A*sin(q + phi), A = m*g*r

A - N*m; q - angle - rad.
"""

from collections.abc import Mapping

from bench.effects.mjcf import Spec, passive_motor
from bench.effects.signals import Axis, AxisState, Number, Values
from bench.effects.torque import Torque
from bench.effects.waves import PHASE, Wave
from bench.units import Quantity


class Unbalance(Wave, Torque):
    name = "unbalance"
    summary = "an eccentric mass under gravity, once per revolution"
    external = True
    transmitted = True
    quantities = (Quantity("amplitude", "A", "N*m", lower=0.0, null=0.0), PHASE)
    looks_like = ("torque_scale",)

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return self.wave(values, at.position)

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A torque of one period a revolution: an eccentric body would add inertia that J contains already."""
        passive_motor(spec, name, cogging=(-values["amplitude"], 1.0, values["phase"]))


EFFECT = Unbalance()
