"""A coarse torque balance over windows of a recording, to decide whether effort and motion belong together.

    mean effort = J*(change of speed)/(window) + K_w*mean speed + K_0*mean sgn(speed) + M_0 (+ terms of position)

Integrals over windows need no derivative and no filter, so nothing is chosen from a recording before it is known to be
sound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

#: Least number of windows.
LEAST = 60
#: Number of columns of motion; those of position follow.
MOTION = 4
#: Share of the largest singular value below which columns count as dependent.
DEPENDENT = 1e-8


@dataclass(frozen=True, eq=False)
class Balanced:
    """Least squares over windows of one length.

    Attributes:
        sums: of the stretches.
        length: samples a window.
        by_motion, by_position: share of the effort's variance that motion explains, and motion with position.
        theta: J, K_w, K_0, M_0 of the motion with position.
        power: mean of effort times speed.
        columns: (windows, 7).
        effort: mean over each window (windows,).
        starts: first sample of each window (windows,).
    """

    sums: Sequence[Sums]
    length: int
    by_motion: float
    by_position: float
    theta: Array
    power: float
    columns: Array
    effort: Array
    starts: NDArray[np.intp]

    @property
    def inertia(self) -> float:
        """J - kg*m**2 (kg), or what the effort's unit makes of it."""
        return float(self.theta[0])

    @property
    def coulomb(self) -> float:
        """K_0 - the effort's unit."""
        return float(self.theta[2])

    @cached_property
    def audible(self) -> float:
        """Standard deviation of the windows' effort over that of its white noise."""
        noises = [white_noise(part.effort) for part in self.sums if part.windows_of(self.length).size]
        noise = float(np.median(noises)) / np.sqrt(self.length)
        return float(np.std(self.effort)) / noise if noise > 0.0 else np.inf


def balanced(sums: Sequence[Sums], length: int) -> Balanced | None:
    """The balance over windows of one length - samples; None if the recording is too short.

    Motion alone and motion with position are solved from one triangle of their columns.
    """
    windows = [found for part in sums if (found := part.windows(length)) is not None]
    if not windows:
        return None
    columns, mean, starts = (np.concatenate(column) for column in zip(*windows, strict=True))
    varies = float(np.var(mean))
    if mean.size < LEAST or varies == 0.0:
        return None
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    triangle = np.asarray(np.linalg.qr(np.column_stack([columns / scale, mean]), mode="r"))
    shares, theta = [], np.zeros(MOTION)
    for count in (MOTION, columns.shape[1]):
        theta = np.linalg.lstsq(triangle[:, :count], triangle[:, -1], rcond=DEPENDENT)[0]
        left = triangle[:, -1] - triangle[:, :count] @ theta
        shares.append(1.0 - float(left @ left) / mean.size / varies)
    theta, power = (theta / scale)[:MOTION], float(np.mean(mean * columns[:, 1]))
    return Balanced(sums, length, shares[0], shares[1], theta, power, columns, mean, starts)


@dataclass(frozen=True, eq=False)
class Sums:
    """Running sums over a stretch, whose differences give means over windows of any length.

    Attributes:
        start: its first sample.
        period: of the samples - s.
        effort: (n,).
        gone: sum of the speed before each sample, and of all (n + 1,).
        sums: by the trapezoidal rule: speed, its sign, position and its sine and cosine, effort (6, n).
    """

    start: int
    period: float
    effort: Array
    gone: Array
    sums: Array

    @classmethod
    def of(cls, trace: Trace, speed: Array, effort: Array, part: slice) -> Sums:
        """The sums of a stretch.

        Args:
            trace: the recording.
            speed: over the stretch - rad/s (m/s) - (n,).
            effort: over the recording.
            part: the stretch.
        """
        period = trace.sample_period
        travelled = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2.0)]) * period
        position = trace["position"][part] if "position" in trace else travelled
        known = (speed, np.sign(speed), position - position.mean(), np.sin(position), np.cos(position), effort[part])
        signals = np.stack(known)
        sums = np.zeros_like(signals)
        np.cumsum((signals[:, 1:] + signals[:, :-1]) / 2.0, axis=1, out=sums[:, 1:])
        gone = np.concatenate([[0.0], np.cumsum(speed)])
        return cls(part.start, period, effort[part], gone, sums)

    def windows_of(self, length: int) -> NDArray[np.intp]:
        """First samples of half-overlapping windows, none in a stretch of less than three."""
        size, reach = self.sums.shape[1], length // 4
        last = size - length - reach if size >= 3 * length else 0
        return np.arange(reach, last, max(length // 2, 1))

    def windows(self, length: int) -> tuple[Array, Array, NDArray[np.intp]] | None:
        """Columns (windows, 7), mean effort and first samples (windows,); None where there are none."""
        at, reach = self.windows_of(length), length // 4
        if not at.size:
            return None
        change = (_smooth(self.gone, at + length, reach) - _smooth(self.gone, at, reach)) / (length * self.period)
        v, sign, place, sine, cosine, torque = (self.sums[:, at + length] - self.sums[:, at]) / length
        columns = np.column_stack([change, v, sign, np.ones(at.size), place, sine, cosine])
        return columns, torque, at + self.start


def _smooth(gone: Array, at: NDArray[np.intp], reach: int) -> Array:
    """Mean of a signal over `reach` samples to each side, from its running sum."""
    return (gone[at + reach + 1] - gone[at - reach]) / (2 * reach + 1)
