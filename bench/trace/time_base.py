"""Signals with their own sample times, jitter and holes, brought to one regular time base on purpose.

The rules, in order:
1. Time never runs backwards; a time that stands twice keeps its first sample.
2. A step beyond `LONGEST_STEP` sample periods is a hole. Nothing is placed inside it; the segments on both sides stand
   alone.
3. Within a segment sample k stands at t0 + k*T. Times that follow this line exactly stay as they are, bit for bit, and
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
from bench.trace.clock import Clock, Sampled, without_duplicates
from bench.trace.sample_base import LONGEST_STEP, STEADY, Base, find_base
from bench.trace.trace import HOLE, TimeBase

#: Signals whose clock makes the time base, best first.
LEADING = ("velocity", "position", "current", "torque", "force", "voltage")
#: Akima's slopes look at two samples on each side.
_AKIMA = 5


@dataclass(frozen=True)
class Regular:
    """Signals on one regular time base - s, SI - (m,) each, what was found and undone, and what a user should know."""

    time: Array
    signals: Mapping[str, Array]
    time_base: TimeBase
    notes: tuple[str, ...]


def regular(signals: Mapping[str, Sampled]) -> Regular:
    """Bring signals to the regular time base of the leading one.

    Raises:
        InputError: fewer than two samples, time running backwards, or more than 1 % of samples at times already taken.
    """
    leader = next((name for name in LEADING if name in signals), next(iter(signals)))
    clocks = {id(signal.clock): signal.clock for signal in signals.values()}
    of_clock = {key: {n: s.values for n, s in signals.items() if id(s.clock) == key} for key in clocks}
    cleaned = {key: without_duplicates(clocks[key], of_clock[key]) for key in clocks}
    lead = id(signals[leader].clock)
    clock, values, duplicates = cleaned[lead]
    base = find_base(clock, duplicates)
    placed = {name: _on_own_base(base, clock.time, array) for name, array in values.items()}
    notes = list(_notes(base, clock))
    time, valid = base.time, np.ones(base.time.size, dtype=bool)
    for key, (other, others, _) in cleaned.items():
        if key == lead:
            continue
        for name, array in others.items():
            placed[name], known = _on_foreign_base(time, base, clock, other, array)
            valid &= known
        notes.append(_foreign_note(list(others), leader, base, find_base(other, 0)))
    found = base.found
    empty = _empty(signals)
    if empty.size:
        reach = (1.0 if base.resampled else 0.5) * found.sample_period
        full = _distance(time, empty) >= reach
        time, placed, valid = time[full], {name: array[full] for name, array in placed.items()}, valid[full]
        found = replace(found, holes=_holes(time, found.sample_period))
    if not valid.all():
        notes.append(f"{counted(int((~valid).sum()), 'sample')} left out where not every signal is known")
        time, placed = time[valid], {name: array[valid] for name, array in placed.items()}
    if time.size < 2:
        raise InputError(clock.place(None), f"found {time.size} samples common to all signals", "allowed: at least two")
    return Regular(time, {name: placed[name] for name in signals}, found, tuple(notes))


def _empty(signals: Mapping[str, Sampled]) -> Array:
    """Times at which a signal has no value - s."""
    times = [signal.clock.time[signal.unknown] for signal in signals.values() if signal.unknown is not None]
    return np.unique(np.concatenate(times)) if times else np.empty(0)


def _distance(time: Array, others: Array) -> Array:
    """From each time to the nearest of others, which increase - s."""
    bounded = np.concatenate([[-np.inf], others, [np.inf]])
    after = np.searchsorted(others, time) + 1
    return np.minimum(time - bounded[after - 1], bounded[after] - time)


def _holes(time: Array, period: float) -> tuple[tuple[float, float], ...]:
    step = np.diff(time)
    return tuple((float(time[at]), float(step[at])) for at in np.flatnonzero(step > HOLE * period))


def _on_own_base(base: Base, time: Array, values: Array) -> Array:
    """Values of a signal on the base found in its own clock."""
    if base.resampled:
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
    if time.size < _AKIMA:
        return np.interp(at, time, values)
    from scipy.interpolate import Akima1DInterpolator  # 0.15 s, which regular recordings need not pay

    return Akima1DInterpolator(time, values)(np.clip(at, time[0], time[-1]))


def _on_foreign_base(
    time: Array, base: Base, clock: Clock, other: Clock, values: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Values of a signal of another clock on the base, and where they are known."""
    same = other.time.size == clock.time.size and base.measured is None and not base.resampled
    if same and np.abs(other.time - clock.time).max() <= max(clock.quantum, other.quantum) * (1.0 + 1e-3):
        return values, np.ones(time.size, dtype=bool)  # the same instants, stamped apart by their rounding
    step = np.diff(other.time)
    reach = LONGEST_STEP * float(np.median(step))
    after = np.clip(np.searchsorted(other.time, time), 1, other.time.size - 1)
    slack = 0.5 * base.found.sample_period
    inside = (time >= other.time[0] - slack) & (time <= other.time[-1] + slack)
    known = inside & ((step[after - 1] <= reach) | np.isin(time, other.time))
    return interpolate(time, other.time, values), known


def _notes(base: Base, clock: Clock) -> list[str]:
    found, notes = base.found, []
    if found.resampled:
        notes.append(
            f"times jitter by up to {found.jitter:.0%} of a sample period; signals interpolated onto regular times"
        )
    elif base.time is not clock.time and clock.quantum > 2.0 * STEADY * found.sample_period:
        notes.append(f"times are rounded to {clock.quantum:g} s; replaced by the line through them")
    if found.interpolated:
        notes.append(f"{counted(found.interpolated, 'missing sample')} interpolated")
    if found.holes:
        longest = max(duration for _, duration in found.holes)
        notes.append(f"{counted(len(found.holes), 'hole')}, the longest {longest:.3g} s; nothing is placed inside")
    if found.duplicates:
        notes.append(f"{counted(found.duplicates, 'sample')} dropped at times that stood already in the recording")
    if clock.time.size < 10:
        notes.append(f"only {clock.time.size} samples")
    return notes


def counted(count: int, what: str) -> str:
    """`1 hole`, `2 holes`."""
    return f"{count} {what}{'s' * (count != 1)}"


def _foreign_note(names: list[str], leader: str, base: Base, other: Base) -> str:
    every, own = other.found.sample_period, base.found.sample_period
    who = ", ".join(names)
    return f"{who} sampled every {every:g} s by a clock of its own; taken at the times of {leader}, every {own:g} s"
