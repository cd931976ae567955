"""A coarse torque balance over windows of a recording, to decide whether effort and motion belong together.

    mean effort = J*(change of speed)/(window) + K_w*mean speed + K_0*mean sgn(speed) + M_0 (+ terms of position)

Integrals over windows need no derivative and no filter, so nothing is chosen from a recording before it is known to be
sound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.gate.parts import speed_of, stretches
from bench.rig.rig import Rig
from bench.trace.known_torque import less_known
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

#: Lengths of windows tried - samples -; the one that explains most is taken.
LENGTHS = (4, 16, 64, 256)
#: Least number of windows.
LEAST = 60
#: Number of columns of motion; those of position follow.
MOTION = 4
EFFORTS = ("torque", "force", "current", "voltage")


@dataclass(frozen=True)
class Balance:
    """Least squares over windows of one length.

    Attributes:
        length: samples a window.
        by_motion, by_position: share of the effort's variance that motion explains, and motion with position.
        theta: J, K_w, K_0, M_0 of the motion with position.
        power: mean of effort times speed.
        audible: standard deviation of the windows' effort over that of its white noise.
        columns: (windows, 7).
        effort: mean over each window (windows,).
        starts: first sample of each window (windows,).
    """

    length: int
    by_motion: float
    by_position: float
    theta: Array
    power: float
    audible: float
    columns: Array
    effort: Array
    starts: NDArray[np.intp]


def effort_of(trace: Trace, rig: Rig | None) -> tuple[Array, str] | None:
    """Effort and its name: by the rig, else the first signal of EFFORTS; None without one."""
    names = [name for name in EFFORTS if name in trace]
    if not names:
        return None
    if rig is None:
        return trace[names[0]], names[0]
    effort = less_known(trace, rig.effort(trace)[0])
    direct = rig.axis_kind.effort
    return effort, direct if direct in trace else next(name for name in names if name not in ("torque", "force"))


def balance(trace: Trace, effort: Array, lengths: Sequence[int] = LENGTHS) -> Balance | None:
    """The balance over windows of the length that explains most; None if the recording is too short.

    Args:
        trace: the recording.
        effort: over it (n,).
        lengths: of windows to try - samples.
    """
    parts = [_Summed.of(trace, effort, part) for part in stretches(trace, 3 * min(lengths))]
    found = [one for length in lengths if (one := _balance(parts, length)) is not None]
    return max(found, key=lambda one: one.by_position) if found else None


def _balance(parts: Sequence[_Summed], length: int) -> Balance | None:
    windows = [found for part in parts if (found := part.windows(length)) is not None]
    if not windows:
        return None
    columns, mean, starts = (np.concatenate(column) for column in zip(*windows, strict=True))
    varies = float(np.var(mean))
    if mean.size < LEAST or varies == 0.0:
        return None
    shares, thetas = zip(*(_fitted(columns[:, :count], mean) for count in (MOTION, columns.shape[1])), strict=True)
    noises = [part.noise for part in parts if part.windows_of(length).size]
    noise = float(np.median(noises)) / np.sqrt(length)
    audible = float(np.sqrt(varies)) / noise if noise > 0.0 else np.inf
    power = float(np.mean(mean * columns[:, 1]))
    return Balance(length, shares[0], shares[1], thetas[1][:MOTION], power, audible, columns, mean, starts)


def _fitted(columns: Array, effort: Array) -> tuple[float, Array]:
    """Share of variance explained, and coefficients."""
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    theta = np.linalg.lstsq(columns / scale, effort, rcond=1e-8)[0] / scale
    return 1.0 - float(np.mean((effort - columns @ theta) ** 2)) / float(np.var(effort)), theta


@dataclass(frozen=True)
class _Summed:
    """Running sums over a stretch, whose differences give means over windows of any length.

    Attributes:
        start: its first sample.
        period: of the samples - s.
        gone: sum of the speed before each sample, and of all (n + 1,).
        sums: by the trapezoidal rule: speed, its sign, position and its sine and cosine, effort (6, n).
        noise: standard deviation of the effort's white noise.
    """

    start: int
    period: float
    gone: Array
    sums: Array
    noise: float

    @classmethod
    def of(cls, trace: Trace, effort: Array, part: slice) -> _Summed:
        """The sums of a stretch."""
        speed, period = speed_of(trace, part), trace.sample_period
        assert speed is not None
        travelled = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2.0)]) * period
        position = trace["position"][part] if "position" in trace else travelled
        known = (speed, np.sign(speed), position - position.mean(), np.sin(position), np.cos(position), effort[part])
        signals = np.stack(known)
        sums = np.zeros_like(signals)
        np.cumsum((signals[:, 1:] + signals[:, :-1]) / 2.0, axis=1, out=sums[:, 1:])
        gone = np.concatenate([[0.0], np.cumsum(speed)])
        return cls(part.start, period, gone, sums, white_noise(effort[part]))

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
