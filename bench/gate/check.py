"""A recording as the checks see it - what several of them ask for is computed once -, and the result of a check.

A coarse torque balance over windows of a recording, to decide whether effort and motion belong together.

    mean effort = J*(change of speed)/(window) + K_w*mean speed + K_0*mean sgn(speed) + M_0 (+ terms of position)

Integrals over windows need no derivative and no filter, so nothing is chosen from a recording before it is known to be
sound.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.rig.rig import Rig
from bench.trace.motion import integrated, raw_speed
from bench.trace.noise import white_noise
from bench.trace.trace import Trace, less_known

#: `fail` ends an identification, `warn` is printed.
Status = Literal["pass", "warn", "fail", "not_applicable"]
#: From worst to best.
STATUSES: tuple[Status, ...] = ("fail", "warn", "pass", "not_applicable")


@dataclass(frozen=True)
class Check:
    """Result of a check; `unanswerable`: whether a failed recording is sound, and only insufficient."""

    name: str
    status: Status
    found: str
    allowed: str
    advice: str = ""
    unanswerable: bool = False


def absent(name: str, found: str, allowed: str) -> Check:
    """A check that does not apply to this recording, with what was found."""
    return Check(name, "not_applicable", found, allowed)


#: Deviation of a step from whole sample periods, as share of one, that is reported; more looks like a loss.
JITTER = 0.05
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
        inertia, coulomb: J - kg*m**2 (kg), or what the effort's unit makes of it - and K_0 of the motion with position.
        power: mean of effort times speed.
        columns: (windows, 7).
        effort: mean over each window (windows,).
        starts: first sample of each window (windows,).
    """

    sums: Sequence[Sums]
    length: int
    by_motion: float
    by_position: float
    inertia: float
    coulomb: float
    power: float
    columns: Array
    effort: Array
    starts: NDArray[np.intp]

    @cached_property
    def effort_over_noise(self) -> float:
        """Standard deviation of the windows' effort over that of its white noise."""
        return self._over_noise(self.effort, lambda part: part.effort)

    @cached_property
    def speed_over_noise(self) -> float:
        """The same of the windows' speed."""
        return self._over_noise(self.columns[:, 1], lambda part: np.diff(part.gone))

    def _over_noise(self, means: Array, signal: Callable[[Sums], Array]) -> float:
        noises = [white_noise(signal(part)) for part in self.sums if part.windows_of(self.length).size]
        noise = float(np.median(noises)) / np.sqrt(self.length)
        return float(np.std(means)) / noise if noise > 0.0 else np.inf


def balanced(sums: Sequence[Sums], length: int) -> Balanced | None:
    """The balance over windows of one length - samples; None if the recording is too short.

    Motion alone and motion with position are solved from one triangle of their columns.
    """
    if not sums:
        return None
    windows = zip(*(part.windows(length) for part in sums), strict=True)
    columns, mean, starts = (np.concatenate(column) for column in windows)
    varies = float(np.var(mean)) if mean.size >= LEAST else 0.0
    if varies == 0.0:
        return None
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    triangle = np.asarray(np.linalg.qr(np.column_stack([columns / scale, mean]), mode="r"))
    shares, theta = list[float](), np.zeros(MOTION)
    for count in (MOTION, columns.shape[1]):
        theta = np.linalg.lstsq(triangle[:, :count], triangle[:, -1], rcond=DEPENDENT)[0]
        left = triangle[:, -1] - triangle[:, :count] @ theta
        shares.append(1.0 - float(left @ left) / mean.size / varies)
    inertia, _, coulomb = (theta / scale)[:3].tolist()
    power = float(np.mean(mean * columns[:, 1]))
    return Balanced(sums, length, shares[0], shares[1], inertia, coulomb, power, columns, mean, starts)


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
        """The sums of a stretch, from the speed over it - rad/s (m/s) - (n,) - and the effort over the recording."""
        period = trace.sample_period
        position = trace["position"][part] if "position" in trace else integrated(speed, period)
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

    def windows(self, length: int) -> tuple[Array, Array, NDArray[np.intp]]:
        """Columns (windows, 7), mean effort and first samples (windows,)."""
        at, reach = self.windows_of(length), length // 4
        change = (_smooth(self.gone, at + length, reach) - _smooth(self.gone, at, reach)) / (length * self.period)
        v, sign, place, sine, cosine, torque = (self.sums[:, at + length] - self.sums[:, at]) / length
        columns = np.column_stack([change, v, sign, np.ones(at.size), place, sine, cosine])
        return columns, torque, at + self.start


def _smooth(gone: Array, at: NDArray[np.intp], reach: int) -> Array:
    """Mean of a signal over `reach` samples to each side, from its running sum."""
    return (gone[at + reach + 1] - gone[at - reach]) / (2 * reach + 1)


#: Samples of a stretch, and stretches of a recording, evenly spaced where there are more: they stand for all of it, so
#: that a check costs the same for an hour as for a minute.
LONGEST, MOST = 2**13, 4
#: Lengths of windows of a torque balance - samples -; the one that explains most is taken.
LENGTHS = (4, 16, 64, 256)
EFFORTS = ("torque", "force", "current", "voltage")


@dataclass(frozen=True, eq=False)
class Seen:
    """A recording and, if known, the rig of its axis."""

    trace: Trace
    rig: Rig | None = None
    _balances: dict[int, Balanced | None] = field(default_factory=dict, init=False, repr=False)

    def stretches(self, least: int) -> list[slice]:
        """Stretches without a hole of at least `least` samples: all, or evenly spaced ones of a long recording."""
        pieces = [
            slice(start, min(start + LONGEST, part.stop))
            for part in self.trace.segments
            for start in range(part.start, part.stop, LONGEST)
        ]
        if len(self.trace) > MOST * LONGEST:
            long = [piece for piece in pieces if 2 * (piece.stop - piece.start) > LONGEST] or pieces
            pieces = [long[k] for k in np.unique(np.linspace(0, len(long) - 1, MOST).astype(int))]
        return [piece for piece in pieces if piece.stop - piece.start >= least]

    @property
    def tells_motion(self) -> bool:
        """Whether position or speed is recorded."""
        return "position" in self.trace or "velocity" in self.trace

    def speed(self, part: slice) -> Array:
        """Speed over a stretch (n,) - rad/s (m/s): the reported one, else the position's."""
        trace = self.trace
        if "velocity" in trace:
            return trace["velocity"][part]
        return raw_speed(trace["position"][part], "position", trace.sample_period)

    @cached_property
    def effort(self) -> tuple[Array, str] | None:
        """Effort and its name: by the rig, else the first signal of EFFORTS; None without one."""
        trace, rig = self.trace, self.rig
        names = [name for name in EFFORTS if name in trace]
        if not names:
            return None
        if rig is None:
            return trace[names[0]], names[0]
        effort = less_known(trace, rig.effort(trace)[0])
        direct = rig.axis_kind.effort
        return effort, direct if direct in trace else next(name for name in names if name not in ("torque", "force"))

    def balance(self, lengths: Iterable[int] = LENGTHS) -> Balanced | None:
        """The torque balance over windows of the length that explains most, of these - samples -; None without any."""
        for length in lengths:
            if length not in self._balances:
                self._balances[length] = balanced(self._sums, length)
        found = [one for length in lengths if (one := self._balances[length]) is not None]
        return max(found, key=lambda one: one.by_position, default=None)

    @property
    def unbalanced(self) -> str:
        """Why there is no balance."""
        if self.effort is None or not self.tells_motion:
            return "not both effort and motion are recorded"
        return f"too few samples, or {self.effort[1]} never changes"

    @cached_property
    def _sums(self) -> list[Sums]:
        if self.effort is None or not self.tells_motion:
            return []
        effort, _ = self.effort
        return [Sums.of(self.trace, self.speed(part), effort, part) for part in self.stretches(3 * min(LENGTHS))]


#: A recording as it was meant, beside the result of a check that could put right what it found.
Repaired = tuple[Check, Trace]
#: What each check is: a question to a recording; None where it is not asked of such a one.
Look = Callable[[Seen], Check | Repaired | None]


def resolution_of(values: Array) -> float:
    """Smallest step between successive values (n,) that differ, in their unit; 0 where none do."""
    steps = np.abs(np.diff(values))
    return float(steps.min(where=steps > 0.0, initial=np.inf)) if steps.any() else 0.0
