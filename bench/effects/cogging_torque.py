"""Cogging torque: periodic in position and independent of current, from magnets meeting teeth.

    M = A*sin(n*q + phi)

A - amplitude - N*m; n - harmonic, cycles per revolution, two or more; q - angle - rad.
Source: D. C. Hanselman, Brushless Permanent Magnet Motor Design, 2nd ed., 2003, ch. 5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from bench.effects.acting import Native
from bench.effects.axis import Axis
from bench.effects.effect import Repeatable, Wave
from bench.effects.mjcf import add_periodic_torque
from bench.effects.signals import Base, Shape, Signals
from bench.effects.waves import amplitude_and_phase, followed
from bench.trace.filter import Column
from bench.units import Quantity

if TYPE_CHECKING:  # 0.2 s, needed only to simulate
    import mujoco


class CoggingTorque(Wave, Repeatable, Native):
    """See the module."""

    name = "cogging_torque"
    summary = "torque periodic in position, independent of current"
    quantities = (
        Quantity("amplitude", "A", "N*m", lower=0.0, null=0.0),
        Quantity("harmonic", "n", "dimensionless", lower=2.0, linear_unit="rad/m"),
        Quantity("phase", "phi", "rad", angle=True, preset=0.0),
    )
    shapes = (Shape(quantities[1], tuple(float(n) for n in range(2, 81)), whole=True),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """sin(n*q) and cos(n*q), nothing where the wave is faster than the samples can follow."""
        angle, slow = shape[0] * signals.position, followed(signals, shape[0])
        return [[(np.sin(angle) * slow, 0)], [(np.cos(angle) * slow, 0)]]

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Amplitude, harmonic and phase."""
        amplitude, phase = amplitude_and_phase(*strengths)
        return {"amplitude": amplitude, "harmonic": shape[0], "phase": phase}

    def add(self, spec: mujoco.MjSpec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """A passive DC motor that cogs."""
        add_periodic_torque(spec, name, values["amplitude"], values["harmonic"], values["phase"])


EFFECT = CoggingTorque()
