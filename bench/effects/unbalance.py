"""Unbalance: an eccentric mass under gravity, once per revolution.

    M = A*sin(q + phi), A = m*g*r

A - N*m; q - angle - rad.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from bench.arrays import namespace
from bench.effects.acting import LoadTorque, Native
from bench.effects.axis import Axis, Moment, Number, Values
from bench.effects.effect import OncePerRevolution, OuterTorque
from bench.effects.mjcf import add_periodic_torque
from bench.effects.signals import Base, Signals
from bench.effects.waves import amplitude_and_phase
from bench.trace.filter import Column
from bench.units import Quantity

if TYPE_CHECKING:  # 0.2 s, needed only to simulate
    import mujoco


class Unbalance(OncePerRevolution, OuterTorque, LoadTorque, Native):
    """See the module."""

    name = "unbalance"
    summary = "an eccentric mass under gravity, once per revolution"
    quantities = (
        Quantity("amplitude", "A", "N*m", lower=0.0, null=0.0),
        Quantity("phase", "phi", "rad", angle=True, preset=0.0),
    )

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """sin(q) and cos(q)."""
        return [[(np.sin(signals.position), 0)], [(np.cos(signals.position), 0)]]

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Amplitude and phase."""
        amplitude, phase = amplitude_and_phase(*strengths)
        return {"amplitude": amplitude, "phase": phase}

    def load_torque(self, values: Values, at: Moment) -> Number:
        """By the equation above."""
        angle = at.position + values["phase"]
        return values["amplitude"] * namespace(angle).sin(angle)

    def add(self, spec: mujoco.MjSpec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A torque of one period a revolution: an eccentric body would add inertia that J holds already."""
        add_periodic_torque(spec, name, values["amplitude"], 1.0, values["phase"])


EFFECT = Unbalance()
