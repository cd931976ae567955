"""A position that wraps made continuous: by the period that the user tells, or by one that is plain.

A wrapped position leaps by nearly its period P from one end of its range to the other; the step that was really made
is that of its neighbours. So each leap d between neighbouring steps s tells P = |d - s|. P is exact where all leaps
agree on a whole number of turns or on a power of two counts, of which a counter is made; where they agree on another
one, `wraps` takes that as it comes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.errors import InputError

#: A leap exceeds this share of the range, and its neighbours by this factor.
_LEAP, _FACTOR = 0.5, 4.0
#: Steps beyond this share of the period may be one turn more or less.
_SURE = 0.45
#: Standard errors, and share of a period, within which leaps agree with one that is plain: 25 rad, by which CAN drives
#: wrap, is 0.5 % off four turns.
SURE, PLAIN = 4.0, 3e-3
_TURNS = tuple(2.0 * math.pi * turns for turns in (0.5, 1.0, 2.0, 4.0, 8.0, 16.0))
_POWERS = range(8, 33)


@dataclass(frozen=True)
class Unwrapped:
    """A continuous position - SI - (n,), the period taken out of it, and how often."""

    values: Array
    period: float
    count: int


class Unwrapping:
    """A position made continuous piece by piece: what was found in one piece holds in those that follow."""

    def __init__(self, told: float | None) -> None:
        self.period, self.turned, self.last = told, 0.0, np.empty(0)

    def __call__(
        self, position: Array, time: Array, speed: Array | None, factor: float, place: Callable[[int | None], str]
    ) -> Unwrapped | None:
        """As `unwrapped`; the last sample of the piece before stands in front of this one."""
        before = self.last.size
        joined = np.concatenate([self.last, position])
        found = unwrapped(joined, time, None if before else speed, factor, self.period, place)
        self.last = position[-1:].copy()
        if found is None:
            return None if self.turned == 0.0 else Unwrapped(position + self.turned, self.period or 0.0, 0)
        self.period = found.period
        values = found.values[before:] + self.turned
        self.turned += float(found.values[-1] - joined[-1])
        return Unwrapped(values, found.period, found.count)


def unwrapped(
    position: Array,
    time: Array,
    speed: Array | None,
    factor: float,
    told: float | None,
    place: Callable[[int | None], str],
) -> Unwrapped | None:
    """The position made continuous; None where it does not wrap.

    Args:
        position: SI - (n,).
        time: s - (n,).
        speed: SI - (n,) at the same times, where it is recorded.
        factor: SI per unit of the file, of which a counter wraps at a power of two.
        told: period that the user tells - SI.
        place: where sample i stands in the file, for messages.

    Raises:
        InputError: it spans more than its period, or moves by more than half of one a sample.
    """
    if position.size < 4:
        return None
    period = told if told is not None else _plain_period(position, factor)
    if period is None:
        return None
    if np.ptp(position) > 1.01 * period:
        found = f"spans {np.ptp(position):.6g}, more than its period {period:.6g}"
        raise InputError(place(None), found, "allowed: a position_period that it wraps by, or none where it does not")
    steps = np.diff(position)
    turns = np.rint(steps / period)
    true = steps - turns * period
    if np.abs(true).max() > _SURE * period:
        if speed is None or speed.size != position.size:
            first = int(np.argmax(np.abs(true) > _SURE * period)) + 1
            raise InputError(
                place(first),
                f"the position moves by half of its period {period:.6g} from one sample to the next",
                "allowed: less, or a recorded velocity; record faster",
            )
        expected = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time)
        turns = np.rint((steps - expected) / period)
    if not turns.any():
        return None
    return Unwrapped(position - period * np.concatenate([[0.0], np.cumsum(turns)]), period, int(np.abs(turns).sum()))


def _plain_period(position: Array, factor: float) -> float | None:
    """The period of turns, or of a power of two counts, that leaps of a position agree on; None where they do not."""
    spread = float(np.ptp(position))
    steps = np.diff(position)
    at = np.flatnonzero(np.abs(steps) > _LEAP * spread)
    if not at.size or spread == 0.0:
        return None
    plain = np.delete(steps, at)
    if not plain.size or np.abs(steps[at]).min() < _FACTOR * np.abs(plain).max():
        return None
    leaping = np.zeros(steps.size, dtype=bool)
    leaping[at] = True
    smooth = np.where(leaping, np.nan, steps)
    before, after = np.concatenate([[np.nan], smooth[:-1]])[at], np.concatenate([smooth[1:], [np.nan]])[at]
    own = np.nanmean(np.vstack([before, after, np.where(np.isnan(before) & np.isnan(after), 0.0, np.nan)]), axis=0)
    periods = np.abs(steps[at] - own)
    rough = float(np.median(periods))
    middle = smooth[1:-1] - 0.5 * (smooth[:-2] + smooth[2:])
    single = SURE * float(np.nanstd(middle)) + abs(factor)
    doubt = single / math.sqrt(at.size)
    if np.ptp(periods) > 2.0 * single * math.sqrt(at.size) or spread > rough + single:
        return None
    counts = [factor * 2.0**power for power in _POWERS]
    near = [period for period in (*_TURNS, *counts) if abs(period - rough) <= min(doubt, PLAIN * rough)]
    if near:
        return min(near, key=lambda period: abs(period - rough))
    return None
