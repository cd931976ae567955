"""Signals with their own sample times, jitter and holes, brought to one regular time base on purpose.

The rules, in order:
1. Samples that come in another order are sorted, where that makes the times regular; otherwise time never runs
   backwards. A repeated time keeps its first sample.
2. A step beyond `LONGEST_STEP` sample periods is a hole. Nothing is placed inside it; the segments on both sides stand
   alone.
3. Within a segment sample k is at t0 + k*T. Times that follow this line exactly stay as they are, bit for bit, and
   so do their values. Times that follow it within their own rounding are replaced by the line; values stay as they
   are. Samples missing from the line are interpolated.
4. Only where times really jitter are signals interpolated, onto t0 + k*(median step).
5. The velocity's clock (else the position's) makes the base; signals of other clocks are interpolated onto it, never
   across their own holes or beyond their ends.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.errors import InputError
from bench.names import counted, percent
from bench.trace.in_si import Clock, SampledSignal

#: A step this many sample periods long is a hole, not jitter: no signal of a servo is known inside it.
HOLE = 1.5
#: Steps up to this many sample periods are filled; a longer one is a hole.
LONGEST_STEP = 2.5
#: Deviation from the line, as share of the sample period, that is no more than the rounding of floats.
EXACT = 1e-6
#: Deviation from the line, as share of the sample period, below which interpolating would change nothing that matters.
STEADY = 1e-3
#: Times rounded to q have q/sqrt(12) of noise, which tilts a line fitted to n of them: their peak-to-peak deviation
#: exceeds q by up to 2*3 standard deviations at its ends, 6*q*sqrt(3/(12*n)) = 3*q/sqrt(n).
_SLOPE = 3.0
#: Signals whose clock makes the time base, best first.
LEADING = ("velocity", "position", "current", "torque", "force", "voltage")
#: Largest share of samples with a time that another sample already has, and other values.
MOST_DUPLICATES = 0.01
#: Akima's slopes look at two samples on each side.
_AKIMA = 5


@dataclass(frozen=True)
class TimeBase:
    """Sample times as found by a reader, before they were brought to a regular base.

    Attributes:
        sample_period: median step - s.
        jitter: largest deviation of a step (holes aside) from the sample period - share of the period.
        holes: (start, duration) of each stretch without samples - s.
        duplicates: samples dropped because the recording already has their time.
        interpolated: samples placed between measured ones, inside steps too short to be a hole.
        resampled: whether signals were interpolated onto the regular base.
        steps: between which four of five steps are, where they are not regular - s.
    """

    sample_period: float
    jitter: float = 0.0
    holes: tuple[tuple[float, float], ...] = ()
    duplicates: int = 0
    interpolated: int = 0
    resampled: bool = False
    steps: tuple[float, float] | None = None


@dataclass(frozen=True)
class Regular:
    """Signals on one regular time base - s, SI - (m,) each, what was found and undone, and what a user should know."""

    time: Array
    signals: Mapping[str, Array]
    time_base: TimeBase
    notes: tuple[str, ...]


def regular(signals: Mapping[str, SampledSignal]) -> Regular:
    """Bring signals to the regular time base of the leading one.

    Raises:
        InputError: fewer than two samples, time running backwards, or more than 1 % of samples at times already taken.
    """
    leader = next((name for name in LEADING if name in signals), next(iter(signals)))
    of_clock: dict[Clock, dict[str, Array]] = {}
    for name, signal in signals.items():
        of_clock.setdefault(signal.clock, {})[name] = signal.values
    ordered = {recorded: _in_order(recorded, values) for recorded, values in of_clock.items()}
    cleaned = {recorded: _without_duplicates(*one[:2]) for recorded, one in ordered.items()}
    clock, values, duplicates = cleaned.pop(signals[leader].clock)
    base = _find(clock, duplicates)
    placed = {name: _on_own_base(base, clock.time, array) for name, array in values.items()}
    notes = [*dict.fromkeys(note for *_, note in ordered.values() if note), *_notes(base, clock)]
    time, valid = base.time, np.ones(base.time.size, dtype=bool)
    for other, others, _ in cleaned.values():
        for name, array in others.items():
            placed[name], known = _on_foreign_base(time, base, clock, other, array)
            valid &= known
        every = _find(other, 0).found.sample_period
        sampled = f"{', '.join(others)} sampled every {every:g} s by a clock of its own"
        notes.append(f"{sampled}; taken at the times of {leader}, every {base.found.sample_period:g} s")
    found = base.found
    unknown = [signal.clock.time[signal.unknown] for signal in signals.values() if signal.unknown is not None]
    if unknown:
        reach = (1.0 if found.resampled else 0.5) * found.sample_period
        full = _distance(time, np.unique(np.concatenate(unknown))) >= reach
        time, placed, valid = time[full], {name: array[full] for name, array in placed.items()}, valid[full]
        edges = np.flatnonzero(np.diff(time) > HOLE * found.sample_period)
        found = replace(found, holes=tuple((float(time[k]), float(time[k + 1] - time[k])) for k in edges))
    if not valid.all():
        notes.append(f"{counted(int((~valid).sum()), 'sample')} left out where not every signal is known")
        time, placed = time[valid], {name: array[valid] for name, array in placed.items()}
    if time.size < 2:
        raise InputError(clock.place(None), f"found {time.size} samples common to all signals", "allowed: at least two")
    return Regular(time, {name: placed[name] for name in signals}, found, tuple(notes))


def _in_order(clock: Clock, values: Mapping[str, Array]) -> tuple[Clock, Mapping[str, Array], str]:
    """The clock and its signals by increasing times, and a note on what was done.

    InputError where times run backwards and sorting does not make them regular.
    """
    time = clock.time
    back = np.flatnonzero(np.diff(time) < 0) + 1
    if not back.size:
        return clock, values, ""
    order = np.argsort(time, kind="stable")
    steps = np.diff(time[order])
    if steps.min() <= 0.5 * float(np.median(steps)):
        first = int(back[0])
        found = f"time runs backwards ({time[first - 1]:g} s, then {time[first]:g} s)"
        raise InputError(clock.place(first), found, "allowed: increasing times")
    by_time = Clock(time[order], clock.recorded[order], clock.tick, lambda k: clock.place(_from(order, k)))
    note = f"{counted(back.size, 'sample')} earlier than the one before; sorted by time"
    return by_time, {name: array[order] for name, array in values.items()}, note


def _from(order: NDArray[np.intp], place: int | None) -> int | None:
    """Where a sample was before it was sorted."""
    return None if place is None else int(order[place])


def _without_duplicates(clock: Clock, values: Mapping[str, Array]) -> tuple[Clock, Mapping[str, Array], int]:
    """The clock and its signals without samples at a time already taken, and how many those were."""
    time = clock.time
    if time.size < 2:
        raise InputError(clock.place(None), f"found {counted(time.size, 'sample')}", "allowed: at least two")
    if (time[1:] > time[:-1]).all():
        return clock, values, 0
    step = np.diff(time)
    again = np.concatenate([[False], step == 0])
    other = again & np.logical_or.reduce([np.concatenate([[False], np.diff(v) != 0]) for v in values.values()])
    if other.sum() > MOST_DUPLICATES * time.size:
        raise InputError(
            clock.place(int(np.argmax(other))),
            f"{int(other.sum())} of {time.size} samples repeat the time of another one, with other values",
            "allowed: at most 1 %; record with finer time stamps, or give sample_period in the rig's [trace]",
        )
    kept = {name: array[~again] for name, array in values.items()}
    return Clock(time[~again], clock.recorded[~again], clock.tick, clock.place), kept, int(again.sum())


def _distance(time: Array, others: Array) -> Array:
    """From each time to the nearest of others, which increase - s."""
    bounded = np.concatenate([[-np.inf], others, [np.inf]])
    after = np.searchsorted(others, time) + 1
    return np.minimum(time - bounded[after - 1], bounded[after] - time)


def _on_own_base(base: _RegularTimes, time: Array, values: Array) -> Array:
    """Values of a signal on the base found in its own clock."""
    if base.found.resampled:
        return interpolate(base.time, time, values)
    if base.measured is None:
        return values
    placed = np.empty(base.time.size)
    placed[base.measured] = values
    placed[~base.measured] = interpolate(base.time[~base.measured], base.time[base.measured], values)
    return placed


def interpolate(at: Array, time: Array, values: Array) -> Array:
    """Values at other times, held beyond the ends; by Akima's local cubics (J. ACM 17, 1970, 589).

    They do not overshoot at the steps of a current and leave noise nearly as it is, which linear interpolation lessens
    and splines do not respect: measured in `tests/trace/test_time_base.py`.
    """
    with np.errstate(over="ignore", divide="ignore"):
        steepest = 8.0 * np.ptp(values) / np.diff(time).min(initial=np.inf) ** 3  # no coefficient is larger
    if time.size < _AKIMA or not np.isfinite(steepest):
        return np.interp(at, time, values)
    from scipy.interpolate import Akima1DInterpolator  # 0.15 s, which regular recordings need not pay

    return Akima1DInterpolator(time, values)(np.clip(at, time[0], time[-1]))


def _on_foreign_base(
    time: Array, base: _RegularTimes, clock: Clock, other: Clock, values: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Values of a signal of another clock on the base, and where they are known."""
    same = other.time.size == clock.time.size and base.measured is None and not base.found.resampled
    if same and np.abs(other.time - clock.time).max() <= max(clock.quantum, other.quantum) * (1.0 + 1e-3):
        return values, np.ones(time.size, dtype=bool)  # the same instants, with time stamps that differ by rounding
    step = np.diff(other.time)
    reach = LONGEST_STEP * float(np.median(step))
    after = np.clip(np.searchsorted(other.time, time), 1, other.time.size - 1)
    slack = 0.5 * base.found.sample_period
    inside = (time >= other.time[0] - slack) & (time <= other.time[-1] + slack)
    known = inside & ((step[after - 1] <= reach) | np.isin(time, other.time))
    return interpolate(time, other.time, values), known


def _notes(base: _RegularTimes, clock: Clock) -> list[str]:
    found, notes = base.found, []
    if found.resampled:
        jitter = f"times jitter by up to {percent(found.jitter)} of a sample period"
        notes.append(f"{jitter}; signals interpolated onto regular times")
    elif base.time is not clock.time and clock.quantum > 2.0 * STEADY * found.sample_period:
        notes.append(f"times are rounded to {clock.quantum:g} s; replaced by the line through them")
    if found.interpolated:
        notes.append(f"{counted(found.interpolated, 'missing sample')} interpolated")
    if found.holes:
        longest = max(duration for _, duration in found.holes)
        notes.append(f"{counted(len(found.holes), 'hole')}, the longest {longest:.3g} s; nothing is placed inside")
    if found.duplicates:
        notes.append(
            f"{counted(found.duplicates, 'sample')} dropped because the recording already has a sample at that time"
        )
    if clock.time.size < 10:
        notes.append(f"only {clock.time.size} samples")
    return notes


@dataclass(frozen=True, eq=False)
class _RegularTimes:
    """Times of a clock, regular within each segment - s - (m,) -, which of them were measured, and what it was like.

    Measured is each where `measured` is None, unless it was resampled.
    """

    time: Array
    measured: NDArray[np.bool_] | None
    found: TimeBase


def _find(clock: Clock, duplicates: int) -> _RegularTimes:
    """The regular time base in increasing sample times."""
    time = clock.time
    if time.size < 2:
        raise InputError(clock.place(None), f"found {time.size} different times", "allowed: at least two")
    period = float(time[-1] - time[0]) / (time.size - 1)
    spread = float(np.ptp(time - period * np.arange(time.size))) / period
    if spread <= EXACT:
        return _RegularTimes(time, None, TimeBase(period, spread, duplicates=duplicates))
    step = np.diff(time)
    period = float(np.median(step))
    contiguous = step[step <= LONGEST_STEP * period]
    edges = np.flatnonzero(step > LONGEST_STEP * period) + 1
    holes = tuple((float(time[edge - 1]), float(step[edge - 1])) for edge in edges)
    segments = np.split(time, edges)
    mean = float(contiguous.mean())
    counts = [np.arange(times.size, dtype=float) for times in segments]
    line, starts, spread = _line(segments, counts, mean)
    tolerance = max(clock.quantum * (1.0 + _SLOPE / np.sqrt(time.size)), 2.0 * STEADY * mean)
    if spread > tolerance:
        counts = [np.append(0.0, np.cumsum(np.maximum(np.rint(np.diff(times) / period), 1.0))) for times in segments]
        line, starts, spread = _line(segments, counts, period)
    if spread > tolerance:
        missing = int(np.maximum(np.rint(contiguous / period), 1.0).sum()) - contiguous.size
        usual = (float(np.percentile(step, 10.0)), float(np.percentile(step, 90.0)))
        found = TimeBase(period, _jitter(contiguous, period), holes, duplicates, missing, True, usual)
        placed = [t[0] + period * np.arange(int((t[-1] - t[0]) / period + EXACT) + 1) for t in segments]
        return _RegularTimes(np.concatenate(placed), None, found)
    missing = int(sum(count[-1] + 1 - count.size for count in counts))
    found = TimeBase(line, _jitter(contiguous, line), holes, duplicates, missing)
    if spread <= EXACT * line and not missing:
        return _RegularTimes(time, None, found)
    every = [np.arange(count[-1] + 1.0) for count in counts]
    measured = np.concatenate([np.isin(all_of, count) for all_of, count in zip(every, counts, strict=True)])
    placed = [start + line * all_of for start, all_of in zip(starts, every, strict=True)]
    return _RegularTimes(np.concatenate(placed), None if measured.all() else measured, found)


def _line(segments: list[Array], counts: list[Array], guess: float) -> tuple[float, list[float], float]:
    """Fit t = start + k*T to the times of all segments, k counts: T, start of each, largest spread in one - s each.

    Least squares; T is `guess` where no segment has two samples.
    """
    along, across = 0.0, 0.0
    for times, count in zip(segments, counts, strict=True):
        centred = count - count.mean()
        # times relative to the guess keep the sums small: the slope to 1e-12 even far from t = 0
        along += float(centred @ (times - times[0] - guess * count))
        across += float(centred @ centred)
    period = guess + along / across if across > 0.0 else guess
    rests = [times - period * count for times, count in zip(segments, counts, strict=True)]
    return period, [float(rest.mean()) for rest in rests], max(float(np.ptp(rest)) for rest in rests)


def _jitter(step: Array, period: float) -> float:
    """Largest deviation of a step from the nearest whole number of periods - share of the period."""
    return float(np.abs(step / period - np.maximum(np.rint(step / period), 1.0)).max())
