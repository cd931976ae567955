"""References: what a drive is told to follow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array


@dataclass(frozen=True)
class References:
    """A motion at the drive's ticks. Signals have shape (ticks,), or (ticks, axes) for axes side by side.

    Attributes:
        time: of the ticks, from zero - s - (ticks,).
        position: rad (m on a linear axis).
        velocity: rad/s (m/s).
        acceleration: rad/s**2 (m/s**2).
        torque: that is added to the drive's set-point, beside its own feed-forward - N*m (N); None without any.
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    torque: Array | None = None

    def feedforward(self, inertia: Array | float) -> Array:
        """Torque that is fed forward - N*m (N) - by a drive that takes its inertia to be one - kg*m**2 (kg)."""
        accelerating = inertia * self.acceleration
        return accelerating if self.torque is None else accelerating + self.torque

    @property
    def period(self) -> float:
        """Time between ticks - s."""
        return float(self.time[1] - self.time[0])

    def then(self, other: References) -> References:
        """This motion, then another one that starts a tick later from where this one ends, both at rest there."""
        time = np.concatenate([self.time, self.time[-1] + self.period + other.time])
        position = np.concatenate([self.position, self.position[-1] - other.position[0] + other.position])
        velocity = np.concatenate([self.velocity, other.velocity])
        return References(time, position, velocity, np.concatenate([self.acceleration, other.acceleration]))

    def repeated(self, times: int) -> References:
        """This motion so many times, each from where the one before ends."""
        again = self
        for _ in range(times - 1):
            again = again.then(self)
        return again

    def csv(self, period: float, position: tuple[str, float], velocity: tuple[str, float]) -> str:
        """Table for a controller: time, position, velocity, acceleration.

        Args:
            period: between rows - s.
            position, velocity: unit of each, and SI per one of it.
        """
        rows = slice(None, None, max(1, round(period / self.period)))
        (length, per_length), (speed, per_speed) = position, velocity
        moved = self.position / per_length, self.velocity / per_speed, self.acceleration / per_speed
        table = np.stack([signal[rows] for signal in (self.time, *moved)], axis=-1)
        head = f"time [s],position [{length}],velocity [{speed}],acceleration [{speed}/s]"
        return "\n".join([head, *(",".join(f"{value:.9g}" for value in row) for row in table.tolist())]) + "\n"


def side_by_side(references: list[References]) -> References:
    """Motions of several axes over one time, as one of shape (ticks, axes)."""
    return References(
        references[0].time,
        np.stack([r.position for r in references], axis=1),
        np.stack([r.velocity for r in references], axis=1),
        np.stack([r.acceleration for r in references], axis=1),
        np.stack([r.feedforward(0.0) for r in references], axis=1),
    )
