"""A coarse torque balance over windows of a recording: enough to ask whether effort and motion belong together.

    mean effort = J*(change of speed)/(window) + K_w*mean speed + K_0*mean sgn(speed) + M_0 (+ what hangs on position)

Integrals over windows need no derivative and no filter, so nothing has to be chosen from the recording before it is
known to be sound.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.checks.parts import speed_of, stretches
from bench.rig.rig import Rig
from bench.trace.noise import white_noise
from bench.trace.known import less_known
from bench.trace.trace import Trace

#: Samples a window: motions and noises differ, the length that explains most is taken.
LENGTHS = (4, 16, 64, 256)
#: Windows that a comparison needs.
LEAST = 60
#: Columns of the motion alone; behind them, those of position.
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
    """What drives the axis, and what it is called: as the rig has it, else the first signal that may be it."""
    names = [name for name in EFFORTS if name in trace]
    if not names:
        return None
    if rig is None:
        return trace[names[0]], names[0]
    effort = less_known(trace, rig.effort(trace)[0])
    direct = rig.axis_kind.effort
    return effort, direct if direct in trace else next(name for name in names if name not in ("torque", "force"))


def balance(trace: Trace, effort: Array, lengths: Sequence[int] = LENGTHS) -> Balance | None:
    """The balance over the windows that explain most; None where the recording is too short for any.

    Args:
        trace: the recording.
        effort: over it (n,).
        lengths: of windows to try - samples.
    """
    found = [one for length in lengths if (one := _balance(trace, effort, length)) is not None]
    return max(found, key=lambda one: one.by_position) if found else None


def _balance(trace: Trace, effort: Array, length: int) -> Balance | None:
    parts = list(_windows(trace, effort, length))
    if not parts:
        return None
    columns, mean, starts, noises = (np.concatenate(column) for column in zip(*parts, strict=True))
    varies = float(np.var(mean))
    if mean.size < LEAST or varies == 0.0:
        return None
    shares, thetas = zip(*(_fitted(columns[:, :count], mean) for count in (MOTION, columns.shape[1])), strict=True)
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


def _windows(trace: Trace, effort: Array, length: int) -> Iterator[tuple[Array, Array, NDArray[np.intp], Array]]:
    """Half-overlapping windows of each stretch: columns, mean effort, starts, and white noise of the effort."""
    period, reach = trace.sample_period, length // 4
    for part in stretches(trace, 3 * length):
        speed = speed_of(trace, part)
        assert speed is not None
        at = np.arange(reach, speed.size - length - reach, max(length // 2, 1))
        if not at.size:
            continue
        travelled = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2.0)]) * period
        position = trace["position"][part] if "position" in trace else travelled
        gone = np.concatenate([[0.0], np.cumsum(speed)])
        change = (_smooth(gone, at + length, reach) - _smooth(gone, at, reach)) / (length * period)
        known = (speed, np.sign(speed), position - position.mean(), np.sin(position), np.cos(position), effort[part])
        v, sign, place, sine, cosine, torque = (_mean(one, at, length) for one in known)
        columns = np.column_stack([change, v, sign, np.ones(at.size), place, sine, cosine])
        yield columns, torque, at + part.start, np.array([white_noise(effort[part])])


def _smooth(gone: Array, at: NDArray[np.intp], reach: int) -> Array:
    """Mean of a signal over `reach` samples to each side, from its running sum."""
    return (gone[at + reach + 1] - gone[at - reach]) / (2 * reach + 1)


def _mean(values: Array, at: NDArray[np.intp], length: int) -> Array:
    """Mean from sample `at` to `at + length` by the trapezoidal rule."""
    gone = np.concatenate([[0.0], np.cumsum((values[1:] + values[:-1]) / 2.0)])
    return (gone[at + length] - gone[at]) / length
