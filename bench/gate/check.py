"""A recording as the checks see it - what several of them ask for is computed once -, and the result of a check.

A coarse torque balance over windows of a recording decides whether effort and motion belong together.

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

from bench.arrays import Array, symmetric_inverse
from bench.rig.rig import Rig
from bench.trace.motion import integrated, raw_speed
from bench.trace.noise import white_noise
from bench.trace.trace import Trace, less_known

#: `fail` ends an identification, `warn` is printed.
Status = Literal["pass", "warn", "fail", "not_applicable"]
#: From worst to best.
STATUSES: tuple[Status, ...] = ("fail", "warn", "pass", "not_applicable")

#: Deviation of a step from whole sample periods, as share of one, that is reported; more looks like a loss.
JITTER = 0.05
#: Least number of windows.
LEAST = 60
#: Number of columns of motion; those of position follow.
MOTION = 4
#: Share of the power of the strongest combination of scaled columns below which one counts as dependent.
DEPENDENT = 1e-14
#: Samples of a stretch, and evenly spaced stretches of a recording: a check costs the same for an hour as for a minute.
LONGEST, MOST = 2**13, 4
#: Lengths of windows of a torque balance - samples -; the one that explains most is taken.
LENGTHS = (4, 16, 64, 256)
EFFORTS = ("torque", "force", "current", "voltage")


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


@dataclass(frozen=True, eq=False)
class Sums:
    """Running sums over a stretch, whose differences give means over windows of any length.

    Attributes:
        start: its first sample.
        period: of the samples - s.
        speed, effort: (n,).
        gone: sum of the speed before each sample, and of all (n + 1,).
        sums: by the trapezoidal rule: speed, its sign, position and its sine and cosine, effort (6, n).
    """

    start: int
    period: float
    speed: Array
    effort: Array
    gone: Array
    sums: Array

    @classmethod
    def of(cls, trace: Trace, speed: Array, effort: Array, part: slice) -> Sums:
        """The sums of a stretch, from the speed over it - rad/s (m/s) - (n,) - and the effort over the recording."""
        period = trace.sample_period
        position = trace["position"][part] if "position" in trace else integrated(speed, period)
        known = (speed, np.sign(speed), position - position.mean(), np.sin(position), np.cos(position), effort[part])
        sums = np.zeros((len(known), speed.size))
        for total, values in zip(sums, known, strict=True):
            np.cumsum(0.5 * (values[1:] + values[:-1]), out=total[1:])
        return cls(part.start, period, speed, effort[part], np.concatenate([[0.0], np.cumsum(speed)]), sums)

    def places(self, length: int) -> range:
        """First samples of half-overlapping windows, none in a stretch of less than three."""
        size, reach = self.effort.size, length // 4
        last = size - length - reach if size >= 3 * length else 0
        return range(reach, max(last, reach), max(length // 2, 1))

    def windows(self, length: int) -> Array:
        """Seven columns over each window, and its mean effort (8, windows)."""
        at, reach = self.places(length), length // 4

        def smooth(ahead: int) -> Array:
            """Mean speed around the samples some way ahead."""
            first, last = (slice(at.start + ahead + to, at.stop + ahead + to, at.step) for to in (-reach, reach + 1))
            return (self.gone[last] - self.gone[first]) / (2 * reach + 1)

        first, last = (slice(at.start + to, at.stop + to, at.step) for to in (0, length))
        table = np.empty((len(self.sums) + 2, len(at)))
        table[0], table[3] = (smooth(length) - smooth(0)) / (length * self.period), 1.0
        table[1:3], table[4:] = np.split((self.sums[:, last] - self.sums[:, first]) / length, [2])
        return table


@dataclass(frozen=True, eq=False)
class Balanced:
    """Least squares over windows of one length.

    Attributes:
        sums: of the stretches.
        length: samples a window.
        by_motion, by_position: share of the effort's variance that motion explains, and motion with position.
        inertia, coulomb: J - kg*m**2 (kg), or in the effort's unit - and K_0 of the motion with position.
        columns, effort: (windows, 7) and means over each window (windows,).
    """

    sums: Sequence[Sums]
    length: int
    by_motion: float
    by_position: float
    inertia: float
    coulomb: float
    columns: Array
    effort: Array

    @cached_property
    def starts(self) -> NDArray[np.intp]:
        """First sample of each window (windows,)."""
        places = ((part.start, part.places(self.length)) for part in self.sums)
        return np.concatenate([start + np.arange(at.start, at.stop, at.step) for start, at in places])

    @cached_property
    def effort_over_noise(self) -> float:
        """Standard deviation of the windows' effort over that of its white noise."""
        return self._over_noise(self.effort, [part.effort for part in self.sums])

    @cached_property
    def speed_over_noise(self) -> float:
        """The same of the windows' speed."""
        return self._over_noise(self.columns[:, 1], [part.speed for part in self.sums])

    def _over_noise(self, means: Array, signals: Sequence[Array]) -> float:
        noises = [white_noise(signal) for signal in signals if signal.size >= 3 * self.length]
        noise = float(np.median(noises)) / np.sqrt(self.length)
        return float(np.std(means)) / noise if noise > 0.0 else np.inf


def balanced(sums: Sequence[Sums], length: int) -> Balanced | None:
    """The balance over windows of one length - samples; None if the recording is too short."""
    if not sums:
        return None
    table = np.concatenate([part.windows(length) for part in sums], axis=1)
    columns, effort = table[:-1].T, table[-1]
    if effort.size < LEAST or not np.ptp(effort):
        return None
    changes = effort - effort.mean()  # a constant is among the columns
    gram = table[:-1] @ columns
    scale = np.sqrt(np.diag(gram))
    scale = np.where(scale > 0.0, scale, 1.0)
    gram, moment = gram / np.outer(scale, scale), table[:-1] @ changes / scale
    shares, theta = list[float](), np.zeros(MOTION)
    for count in (MOTION, columns.shape[1]):
        theta = symmetric_inverse(gram[:count, :count], DEPENDENT) @ moment[:count]
        shares.append(float(theta @ moment[:count]) / float(changes @ changes))
    inertia, _, coulomb = (theta[:3] / scale[:3]).tolist()
    return Balanced(sums, length, shares[0], shares[1], inertia, coulomb, columns, effort)


def scales(columns: Array) -> Array:
    """Norms of columns (n, c), 1 for one of zeros (c,)."""
    norms = np.sqrt(np.einsum("nc,nc->c", columns, columns))
    return np.where(norms > 0.0, norms, 1.0)


def least_squares(columns: Array, values: Array) -> Array:
    """Coefficients (c,) of columns (n, c) by which they explain values (n,) best, in the values' unit per column's."""
    scale = scales(columns)
    scaled = columns / scale
    return symmetric_inverse(scaled.T @ scaled, DEPENDENT) @ (scaled.T @ values) / scale


def basis_of(columns: Array) -> Array:
    """Orthonormal columns (n, r) that span others (n, c)."""
    columns = columns / scales(columns)
    power, ways = np.linalg.eigh(columns.T @ columns)
    kept = power > DEPENDENT * power[-1]
    return columns @ (ways[:, kept] / np.sqrt(power[kept]))


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


#: A recording as it was meant, with the result of a check that could put right what it found.
Repaired = tuple[Check, Trace]
#: What each check is: a test of a recording; None where it does not apply.
Look = Callable[[Seen], Check | Repaired | None]


def resolution_of(values: Array) -> float:
    """Smallest step between successive values (n,) that differ, in their unit; 0 where none do."""
    steps = np.abs(np.diff(values))
    return float(steps.min(where=steps > 0.0, initial=np.inf)) if steps.any() else 0.0
