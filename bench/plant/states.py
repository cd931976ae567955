"""States: the true motion of axes, before any sensor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.errors import SimulationError

DIVERGED = "the simulation diverged: lower the drive's gains or its control period"


@dataclass(frozen=True)
class States:
    """True motion at the drive's ticks, without any sensor; position and velocity are simultaneous.

    Attributes:
        time: s - (ticks,).
        position: rad (m on a linear axis) - (ticks, axes).
        velocity: rad/s (m/s) - (ticks, axes).
        torque: set-point from each tick to the next - N*m (N) - (ticks, axes).
        motor_torque: what the motor makes; less the emulated friction - N*m (N) - (ticks, axes).

    Raises:
        SimulationError: a value is not finite.
    """

    time: Array
    position: Array
    velocity: Array
    torque: Array
    motor_torque: Array

    def __post_init__(self) -> None:
        if not all(np.isfinite(signal).all() for signal in self._signals):
            raise SimulationError(DIVERGED)

    @classmethod
    def of_one(cls, time: Array, position: Array, velocity: Array, torque: Array) -> States:
        """Motion of one axis without emulated friction, from signals of shape (ticks,)."""
        return cls(time, position[:, None], velocity[:, None], torque[:, None], torque[:, None])

    def axis(self, index: int) -> States:
        """Motion of one axis; signals stay two-dimensional."""
        return States(self.time, *(signal[:, index : index + 1] for signal in self._signals))

    @property
    def _signals(self) -> tuple[Array, ...]:
        return self.position, self.velocity, self.torque, self.motor_torque


def abreast(states: Sequence[States]) -> States:
    """Motions of several axes over one time, as one."""
    signals = (np.concatenate(signal, axis=1) for signal in zip(*(s._signals for s in states), strict=True))
    return States(states[0].time, *signals)
