"""States: the true motion of axes, before any sensor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array

DIVERGED = "the simulation diverged: lower the drive's gains or its control period"


@dataclass(frozen=True)
class States:
    """True motion at a controller's ticks, without any sensor; position and velocity are simultaneous.

    Attributes:
        time: s - (ticks,).
        position: rad (m on a linear axis) - (ticks, axes).
        velocity: rad/s (m/s) - (ticks, axes).
        torque: set-point from each tick to the next - N*m (N) - (ticks, axes).
        motor_torque: what the motor makes; less the emulated friction - N*m (N) - (ticks, axes).
    """

    time: Array
    position: Array
    velocity: Array
    torque: Array
    motor_torque: Array

    @classmethod
    def of_one(cls, time: Array, position: Array, velocity: Array, torque: Array) -> States:
        """Motion of one axis without emulated friction, from signals of shape (ticks,)."""
        return cls(time, position[:, None], velocity[:, None], torque[:, None], torque[:, None])

    def axis(self, index: int, ticks: int | None = None) -> States:
        """Motion of one axis, over its first ticks; signals stay two-dimensional."""
        signals = (signal[:ticks, index : index + 1] for signal in self._signals)
        return States(self.time[:ticks], *signals)

    @property
    def diverged(self) -> bool:
        """Whether a value is not finite: runners leave nan where a simulation diverged."""
        return not all(np.isfinite(signal).all() for signal in self._signals)

    @property
    def _signals(self) -> tuple[Array, ...]:
        return self.position, self.velocity, self.torque, self.motor_torque


def side_by_side(states: Sequence[States]) -> States:
    """Motions of several axes over one time, as one."""
    signals = (np.concatenate(signal, axis=1) for signal in zip(*(s._signals for s in states), strict=True))
    return States(states[0].time, *signals)
