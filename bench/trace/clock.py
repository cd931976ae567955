"""Sample times as recorded: shared by signals, rounded by the recorder, some duplicate or decreasing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.errors import InputError
from bench.trace.channel import Channel
from bench.trace.choose import SignalColumn
from bench.trace.reading_options import ReadingOptions
from bench.trace.signals import scale_in

#: Share of cells that may be empty as lost samples; a column with more of them is sampled by a clock of its own.
FEW = 0.05
#: Share by which the sample period of a rig may differ from the mean step of the times in the file.
PERIOD = 0.01
#: Largest share of samples with a time that another sample already has, and other values.
MOST_DUPLICATES = 0.01


@dataclass(frozen=True, eq=False)
class Clock:
    """Sample times shared by signals.

    Attributes:
        time: s - (n,).
        recorded: the same times in the file's unit, as its digits show them - (n,).
        tick: seconds per file unit.
        place: where sample i stands in the file, for messages.
    """

    time: Array
    recorded: Array
    tick: float
    place: Callable[[int | None], str]

    @cached_property
    def quantum(self) -> float:
        """Step of the decimal grid that all recorded times lie on - s; 0 if there is none.

        Times printed with k decimals stand on the grid 10**-k.
        """
        for decimals in range(7):
            scaled = self.recorded * 10.0**decimals
            rounding = max(1e-6, 4.0 * float(np.spacing(np.abs(scaled).max())))
            if np.abs(scaled - np.rint(scaled)).max() <= rounding:
                return self.tick * 10.0**-decimals
        return 0.0


@dataclass(frozen=True, eq=False)
class SampledSignal:
    """Values of a signal with the clock they were sampled by.

    Attributes:
        clock: its sample times.
        values: SI - (n,).
        unknown: where the file has no value and neighbours were used - (n,); None: nowhere.
    """

    clock: Clock
    values: Array
    unknown: NDArray[np.bool_] | None = None


def require_finite(channel: Channel) -> None:
    """Raise InputError for an infinite value of a channel."""
    infinite = np.isinf(channel.values)
    if infinite.any():
        first = int(np.argmax(infinite))
        raise InputError(channel.place(first), f"found {channel.values[first]}", "allowed: a finite number")


def between_known(values: Array) -> Array:
    """Values (n,) with nan filled in by the line between their neighbours."""
    known, place = ~np.isnan(values), np.arange(values.size)
    return np.interp(place, place[known], values[known])


def without_duplicates(clock: Clock, values: Mapping[str, Array]) -> tuple[Clock, Mapping[str, Array], int]:
    """The clock and its signals without samples at a time already taken, and how many those were.

    Raises:
        InputError: time runs backwards, or more than 1 % of samples repeat a time with other values.
    """
    time = clock.time
    if time.size < 2:
        raise InputError(clock.place(None), f"found {time.size} samples", "allowed: at least two")
    if (time[1:] > time[:-1]).all():
        return clock, values, 0
    step = np.diff(time)
    if (step < 0).any():
        first = int(np.argmax(step < 0)) + 1
        raise InputError(
            clock.place(first),
            f"time runs backwards ({time[first - 1]:g} s, then {time[first]:g} s)",
            "allowed: increasing times",
        )
    again = np.concatenate([[False], step == 0])
    other = again & np.logical_or.reduce([np.concatenate([[False], np.diff(v) != 0]) for v in values.values()])
    if other.sum() > MOST_DUPLICATES * time.size:
        raise InputError(
            clock.place(int(np.argmax(other))),
            f"{int(other.sum())} of {time.size} samples stand at a time already taken, with other values",
            "allowed: at most 1 %; record with finer time stamps, or give sample_period in the rig's [trace]",
        )
    keep = ~again
    kept = {name: array[keep] for name, array in values.items()}
    return Clock(time[keep], clock.recorded[keep], clock.tick, clock.place), kept, int(again.sum())


def clock_of(channel: Channel, time: SignalColumn | None, how: ReadingOptions, notes: list[str]) -> Clock:
    """The clock of a channel: its own times, those of its table, or the sample period's.

    Args:
        channel: whose clock it is.
        time: of its table, if that has one.
        how: it is to be read.
        notes: what the user should know, to be added to.

    Raises:
        InputError: times that are infinite or mostly empty, an index that does not increase, or a sample period that
            the times contradict.
    """
    own = channel.time if channel.time is not None else getattr(time, "channel", None)
    if own is None:
        return _every(how.sample_period, np.arange(channel.values.size, dtype=np.float64), channel)
    scale = time.scale if time is not None and own is time.channel else scale_in("time", own.unit or "s", own.place())
    raw = own.values
    if not np.isfinite(raw).all():
        require_finite(own)
        raw = _filled(own, notes)
    if scale.unit == "samples":
        return _every(how.sample_period, _counts(own, raw), own)
    clock = Clock(raw * scale.factor if scale.factor != 1.0 else raw, raw, scale.factor, own.place)
    return clock if how.sample_period is None else _agreeing(clock, how.sample_period, own, notes)


def _every(period: float | None, count: Array, channel: Channel) -> Clock:
    """The clock of counted samples (n,)."""
    assert period is not None  # `choose` asks for it where there is no time
    return Clock(count * period, count, period, channel.place)


def _filled(time: Channel, notes: list[str]) -> Array:
    """Times with those that are empty taken from their neighbours."""
    unknown = np.isnan(time.values)
    count, first = int(unknown.sum()), time.place(int(np.argmax(unknown)))
    if count > FEW * unknown.size:
        raise InputError(first, f"found {count} of {unknown.size} times empty", f"allowed: {FEW:.0%} of them")
    notes.append(f"{count} times empty, the first at {first}; taken from their neighbours")
    return between_known(time.values)


def _counts(time: Channel, index: Array) -> Array:
    """Samples from the first by an index (n,) that counts them, whatever its usual step."""
    steps = np.diff(index)
    if index.size < 2 or not (steps > 0).all():
        first = int(np.argmax(steps <= 0)) + 1 if index.size > 1 else 0
        raise InputError(time.place(first), "the sample index does not increase", "allowed: an increasing index")
    return (index - index[0]) / float(np.median(steps))


def _agreeing(clock: Clock, period: float, time: Channel, notes: list[str]) -> Clock:
    """The clock, checked against the rig's sample period; times by that period if the clock is too coarse.

    Raises:
        InputError: they contradict each other.
    """
    steps = np.diff(clock.time)
    coarse = steps.size > 0 and float(np.mean(steps == 0.0)) > FEW
    mean = float(clock.time[-1] - clock.time[0]) / max(steps.size, 1)
    slack = float(steps.max(initial=0.0)) / max(steps.size, 1) if coarse else PERIOD * period
    typical = mean if coarse else float(np.median(steps)) if steps.size else period
    if abs(typical - period) > slack + PERIOD * period:
        raise InputError(
            time.place(),
            f"steps by {typical:.6g} s, where the rig's [trace] says sample_period = {period:.6g} s",
            "allowed: one of them, or both alike",
        )
    if not coarse:
        return clock
    notes.append(f"times are too coarse to tell samples apart; taken every {period:g} s, as the rig says")
    count = np.arange(clock.time.size, dtype=np.float64)
    return Clock(clock.time[0] + count * period, count, period, clock.place)
