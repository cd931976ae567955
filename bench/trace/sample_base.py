"""The regular time base in increasing sample times: a line t0 + k*T through each segment between holes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.errors import InputError
from bench.trace.clock import Clock
from bench.trace.trace import TimeBase

#: Steps up to this many sample periods are filled; a longer one is a hole.
LONGEST_STEP = 2.5
#: Deviation from the line, as share of the sample period, that is no more than the rounding of floats.
EXACT = 1e-6
#: Deviation from the line, as share of the sample period, below which interpolating would change nothing that matters.
STEADY = 1e-3
#: Rounded times q apart leave q/sqrt(12) of noise, which tilts a line fitted to n of them: their peak-to-peak deviation
#: exceeds q by up to 2*3 standard deviations at its ends, 6*q*sqrt(3/(12*n)) = 3*q/sqrt(n).
_SLOPE = 3.0


@dataclass(frozen=True, eq=False)
class Base:
    """The regular time base found in a clock.

    Attributes:
        time: regular within each segment - s - (m,).
        measured: which of them are measured samples, in order - (m,); None: each is.
        resampled: whether measured samples do not stand on it, so that values must be interpolated.
        found: what the clock was like.
    """

    time: Array
    measured: NDArray[np.bool_] | None
    resampled: bool
    found: TimeBase


def find_base(clock: Clock, duplicates: int) -> Base:
    """The regular time base in increasing sample times."""
    time = clock.time
    if time.size < 2:
        raise InputError(clock.place(None), f"found {time.size} different times", "allowed: at least two")
    exact = _exact(time)
    if exact is not None:
        return Base(time, None, False, TimeBase(*exact, duplicates=duplicates))
    step = np.diff(time)
    period = float(np.median(step))
    contiguous = step[step <= LONGEST_STEP * period]
    edges = np.flatnonzero(step > LONGEST_STEP * period) + 1
    holes = tuple((float(time[edge - 1]), float(step[edge - 1])) for edge in edges)
    segments = np.split(np.arange(time.size), edges) if edges.size else [np.arange(time.size)]
    mean = float(contiguous.mean())
    line = _line(time, segments, [np.arange(s.size, dtype=float) for s in segments], mean)
    tolerance = max(clock.quantum * (1.0 + _SLOPE / np.sqrt(time.size)), 2.0 * STEADY * mean)
    if line.spread > tolerance:
        counts = [np.concatenate([[0.0], np.cumsum(np.maximum(np.rint(step[s[:-1]] / period), 1.0))]) for s in segments]
        line = _line(time, segments, counts, period)
    if line.spread > tolerance:
        missing = int(np.maximum(np.rint(contiguous / period), 1.0).sum()) - contiguous.size
        return _resampled(
            time, segments, TimeBase(period, _jitter(contiguous, period), holes, duplicates, missing, True)
        )
    missing = int(sum(count[-1] + 1 - count.size for count in line.counts))
    found = TimeBase(line.period, _jitter(contiguous, line.period), holes, duplicates, missing)
    if line.spread <= EXACT * line.period and not missing:
        return Base(time, None, False, found)
    return _snapped(line, found)


def _exact(time: Array) -> tuple[float, float] | None:
    """Period - s - and jitter - share of it - of times that follow one line through their ends exactly; None if not."""
    period = float(time[-1] - time[0]) / (time.size - 1)
    off = np.arange(time.size, dtype=np.float64)
    off *= -period
    off += time
    spread = float(off.max() - off.min()) / period
    return (period, spread) if spread <= EXACT else None


@dataclass(frozen=True, eq=False)
class Line:
    """Fit t = start + k*T to the times of all segments: one period, one start a segment.

    Attributes:
        period: T - s.
        starts: of the segments - s.
        counts: k of each sample, a segment an array.
        spread: largest peak-to-peak deviation within a segment - s.
    """

    period: float
    starts: list[float]
    counts: list[Array]
    spread: float


def _line(time: Array, segments: list[NDArray[np.intp]], counts: list[Array], guess: float) -> Line:
    """Least squares of the times on their counts; `guess` where no segment has two samples."""
    along, across = 0.0, 0.0
    for segment, count in zip(segments, counts, strict=True):
        centred = count - count.mean()
        # times relative to the guess keep the sums small: the slope to 1e-12 even far from t = 0
        along += float(centred @ (time[segment] - time[segment[0]] - guess * count))
        across += float(centred @ centred)
    period = guess + along / across if across > 0.0 else guess
    starts, spread = [], 0.0
    for segment, count in zip(segments, counts, strict=True):
        rest = time[segment] - period * count
        starts.append(float(rest.mean()))
        spread = max(spread, float(np.ptp(rest)))
    return Line(period, starts, counts, spread)


def _jitter(step: Array, period: float) -> float:
    """Largest deviation of a step from the nearest whole number of periods - share of the period."""
    return float(np.abs(step / period - np.maximum(np.rint(step / period), 1.0)).max())


def _snapped(line: Line, found: TimeBase) -> Base:
    times, measured = [], []
    for start, count in zip(line.starts, line.counts, strict=True):
        every = np.arange(count[-1] + 1.0)
        times.append(start + line.period * every)
        measured.append(np.isin(every, count))
    flags = np.concatenate(measured)
    return Base(np.concatenate(times), None if flags.all() else flags, False, found)


def _resampled(time: Array, segments: list[NDArray[np.intp]], found: TimeBase) -> Base:
    times = []
    for segment in segments:
        first, last = time[segment[0]], time[segment[-1]]
        times.append(first + found.sample_period * np.arange(int((last - first) / found.sample_period + EXACT) + 1))
    return Base(np.concatenate(times), None, True, found)
