"""Positions that wrap: a drive counts to the end of a turn, or of its range, and starts over.

A wrapped position jumps by nearly its period P from one end of its range to the other; the true step is about that of
its neighbours. So a jump d next to steps s gives P = |d - s|, on which all jumps have to agree. If a number of turns,
or a power of two counts, agrees with them within noise, P is that.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.errors import InputError

#: Least number of samples in which jumps are looked for.
LEAST = 10
#: Sample periods beyond which a step is a hole in time.
LONGEST_STEP = 2.5
#: A step beyond this share of all travel is a jump, if it is also this many times the longest of the other steps.
FAR, ISOLATED = 0.5, 3.0
#: Relative tolerance between jumps of one period, after the motion during each, which its neighbours give.
ALIKE = 0.02
#: Standard errors, and share of a period, within which jumps agree with an exact one: 25 rad, by which CAN drives wrap,
#: is 0.5 % off four turns.
SURE, EXACT = 4.0, 3e-3
#: Turns and powers of two counts that drives wrap by.
TURNS, POWERS = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0), range(8, 33)
#: Number of steps processed at once: few enough for the processor's cache.
PIECE = 1 << 16
#: A position beyond it - rad (m) - is none, which the checks report; its differences and their sums would overflow.
FARTHEST = 1e150
#: Steps beyond this share of the period are ambiguous by one period.
HALF = 0.45


@dataclass(frozen=True)
class Wraps:
    """Wraps of a position that were undone: its period - rad (m) - and the number of jumps."""

    period: float
    count: int


def jumps(position: Array, time: Array) -> NDArray[np.intp]:
    """Places k (m,) of steps from sample k to the next that no motion makes, in a position (n,) at times - s - (n,).

    Steps over a hole in time are none of them: the axis may be anywhere after it.
    """
    none = np.empty(0, dtype=np.intp)
    if position.size < LEAST:
        return none
    most = FAR * float(np.ptp(position))
    # piece by piece, as hardly a recording has one: arrays of the length of a long one cost more than all the rest
    pieces = (position[start : start + PIECE + 1] for start in range(0, position.size - 1, PIECE))
    if not any((np.abs(np.diff(piece)) > most).any() for piece in pieces):
        return none
    step = np.abs(np.diff(position))
    far = step > most
    passed = np.diff(time)
    near = passed <= LONGEST_STEP * float(np.median(passed))
    far &= near
    others = step[near & ~far]
    alone = far.any() and others.any() and step[far].min() >= ISOLATED * others.max()
    return np.flatnonzero(far) if alone else none


def period_of(position: Array, places: NDArray[np.intp], count: float = 0.0) -> float | None:
    """Period by which a position (n,) - rad (m) - jumps at `places`; None where the jumps are not of one period.

    A count of the file is worth `count` - rad (m), 0 where it is not known.
    """
    step = np.diff(position)
    usual = step.copy()
    usual[places] = np.nan
    beside = np.stack([usual[np.clip(places + side, 0, step.size - 1)] for side in (-1, 1)])
    known = np.isfinite(beside)
    moved = np.where(known, beside, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    found = np.abs(step[places] - moved)
    period = float(np.median(found))
    if np.abs(found - period).max() > ALIKE * period or np.ptp(position) > (1.0 + ALIKE) * period:
        return None
    noise = float(np.nanstd(usual[1:-1] - 0.5 * (usual[:-2] + usual[2:])))
    doubt = min((SURE * noise + count) / math.sqrt(places.size), EXACT * period)
    exact = [*(2.0 * math.pi * turns for turns in TURNS), *(count * 2.0**power for power in POWERS)]
    nearest = min(exact, key=lambda one: abs(one - period))
    return nearest if abs(nearest - period) <= doubt else period


class Unwrapping:
    """A position made continuous piece by piece, with the period found in earlier pieces.

    Args:
        period: if the user gives it - rad (m); None if it is to be found.
    """

    def __init__(self, period: float | None) -> None:
        self.period, self.turned, self.count, self.last = period, 0.0, 0, np.empty((2, 0))

    def __call__(
        self, position: Array, time: Array, speed: Array | None, count: float, place: Callable[[int | None], str]
    ) -> tuple[Array, Wraps | None]:
        """The piece made continuous (n,), and its wraps so far; None while it has none.

        Args:
            position: rad (m) - (n,).
            time: s - (n,).
            speed: rad/s (m/s) - (n,) at the same times, where it is recorded.
            count: what one count of the file is worth - rad (m).
            place: where sample i is in the file, for messages.

        Raises:
            InputError: it spans more than its period, or moves by more than half of one a sample.
        """
        if position.size and not np.abs(position).max() < FARTHEST:
            return position, None
        before = self.last.shape[1]
        joined = np.concatenate([self.last[0], position]) if before else position
        times = np.concatenate([self.last[1], time]) if before else time
        self.last = np.array([position[-1:], time[-1:]])
        if self.period is None:
            places = jumps(joined, times)
            self.period = period_of(joined, places, count) if places.size else None
        if self.period is None:
            return position, None
        turns = _turns(joined, times, None if before else speed, self.period, place)
        moved = self.turned - self.period * np.concatenate([[0.0], np.cumsum(turns)])
        self.turned, self.count = float(moved[-1]), self.count + int(np.abs(turns).sum())
        return position + moved[before:], Wraps(self.period, self.count) if self.count else None


def _turns(
    position: Array, time: Array, speed: Array | None, period: float, place: Callable[[int | None], str]
) -> Array:
    """Number of periods to subtract from each step of a position (n,): (n - 1,)."""
    if np.ptp(position) > 1.01 * period:
        found = f"spans {np.ptp(position):.6g}, more than its period {period:.6g}"
        raise InputError(place(None), found, "allowed: a position_period that it wraps by, or none where it does not")
    steps = np.diff(position)
    turns = np.rint(steps / period)
    doubtful = np.abs(steps - turns * period) > HALF * period
    if not doubtful.any():
        return turns
    if speed is None:
        found = f"the position moves by half of its period {period:.6g} from one sample to the next"
        allowed = "allowed: less, or a recorded velocity; record faster"
        raise InputError(place(int(np.argmax(doubtful)) + 1), found, allowed)
    return np.rint((steps - 0.5 * (speed[1:] + speed[:-1]) * np.diff(time)) / period)
