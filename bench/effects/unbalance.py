"""Unbalance: an eccentric mass under gravity, once per revolution.

    M = A*sin(q + phi), A = m*g*r

A - N*m; q - angle - rad.
"""

from collections.abc import Mapping, Sequence

from bench.effects.acting import LoadTorque, Native, Spec, passive_motor
from bench.effects.signals import Axis, Moment, Number, Signals, Values
from bench.effects.waves import PHASE, OncePerRevolution, once_per_revolution, wave
from bench.trace.filter import Column
from bench.units import Quantity


class Unbalance(OncePerRevolution, LoadTorque, Native):
    name = "unbalance"
    summary = "an eccentric mass under gravity, once per revolution"
    external = True
    quantities = (Quantity("amplitude", "A", "N*m", lower=0.0, null=0.0), PHASE)
    looks_like = ("torque_scale",)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        return once_per_revolution(signals.position, 1.0)

    def load_torque(self, values: Values, at: Moment) -> Number:
        return wave(values, "amplitude", at.position)

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A torque of one period a revolution: an eccentric body would add inertia that J holds already."""
        passive_motor(spec, name, cogging=(-values["amplitude"], 1.0, values["phase"]))


EFFECT = Unbalance()
