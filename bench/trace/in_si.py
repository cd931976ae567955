"""The channels that were chosen in SI units, each with the clock it was sampled by.

Sample times stand as they were recorded: shared by signals, rounded by the recorder, some duplicate or decreasing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, all_finite
from bench.errors import InputError
from bench.names import counted, percent, short
from bench.trace.channel import Channel, Recording
from bench.trace.choose import ENOUGH, ReadingOptions, SignalColumn, missing
from bench.trace.signals import SI_UNITS, scale_in
from bench.trace.wraps import Unwrapping, Wraps

#: Share of cells that may be empty as lost samples; a column with more of them is sampled by a clock of its own.
FEW = 0.05
#: Share by which the sample period of a rig may differ from the mean step of the times in the file.
PERIOD = 0.01
#: Samples between two starts of a clock, at least, and sample periods that are taken to be between them.
SHORTEST_PART, HOLE_OF_START = 50, 10.0


@dataclass(frozen=True, eq=False)
class Clock:
    """Sample times shared by signals.

    Attributes:
        time: s - (n,).
        recorded: the same times in the file's unit, as its digits show them - (n,).
        tick: seconds per file unit.
        place: where sample i is in the file, for messages.
    """

    time: Array
    recorded: Array
    tick: float
    place: Callable[[int | None], str]

    @cached_property
    def quantum(self) -> float:
        """Step of the decimal grid that all recorded times lie on, 10**-k of times with k decimals - s; 0: none."""
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
        wraps: of a position, which were undone.
    """

    clock: Clock
    values: Array
    unknown: NDArray[np.bool_] | None = None
    wraps: Wraps | None = None


def in_si(
    chosen: Mapping[str, SignalColumn],
    recording: Recording,
    how: ReadingOptions,
    notes: list[str],
    wrapping: dict[str, Unwrapping] | None = None,
) -> dict[str, SampledSignal]:
    """Bring the chosen channels of a recording to SI, and add to `notes` what the user should know.

    `wrapping` is what was found of positions in the pieces before, where a recording is read in pieces.

    Raises:
        InputError: no signal, an infinite value, hardly a number, lengths that differ, times that the sample period
            contradicts, or a position that wraps by an unknown period.
    """
    units = {name: choice.scale.unit for name, choice in chosen.items() if name != "time"}
    _one_kind_of_axis(units, recording)
    if not units:
        raise missing(recording, "position or velocity", "map them in the rig's [trace.columns]")
    clocks: dict[Channel | None, Clock] = {}
    signals: dict[str, SampledSignal] = {}
    for name in units:
        channel = chosen[name].channel
        if channel.time not in clocks:
            clock = _clock_of(channel, chosen.get("time"), how, notes)
            several = len({chosen[name].channel.time for name in units}) > 1
            clocks[channel.time] = clock if several else _running_on(clock, notes)
        clock, values = clocks[channel.time], _values(chosen[name])
        if values.size != clock.time.size:
            if not any(name in group for group in ENOUGH):
                continue  # left out below: what nobody needs never stops a file
            allowed = f"allowed: {clock.time.size}, as its time has"
            raise InputError(channel.place(), f"found {values.size} values", allowed)
        signals[name] = _known_samples(name, SampledSignal(clock, values), channel, notes)
    samples = {0, *(clock.time.size for clock in clocks.values())}  # none: what is no column of numbers
    odd = [one for one in recording.channels if one.time is None and one.values.size not in samples]
    if odd:
        shown = ", ".join(f"{short(one.name)} ({one.values.size})" for one in odd[:12])
        notes.append(f"left out, as the length differs from the time's: {shown}{' ...' if odd[12:] else ''}")
    for name in ("position", "position_reference"):
        if name in signals:
            unwrapping = (wrapping if wrapping is not None else {}).setdefault(name, Unwrapping(how.position_period))
            signals[name] = _unwrapped(name, chosen[name], signals, unwrapping, notes)
    return signals


def _one_kind_of_axis(units: Mapping[str, str], recording: Recording) -> None:
    moving = {name: unit for name, unit in units.items() if len(set(SI_UNITS[name])) == 2 and "N" not in unit}
    if len({unit.startswith("m") for unit in moving.values() if unit != "dimensionless"}) > 1:
        found = ", ".join(f"{name} in {unit}" for name, unit in moving.items())
        raise InputError(recording.origin, f"found {found}", "allowed: all of a rotary axis or all of a linear one")


def _values(choice: SignalColumn) -> Array:
    values, factor, offset = choice.channel.values, choice.sign * choice.scale.factor, choice.sign * choice.scale.offset
    _require_finite(choice.channel)
    values = values * factor if factor != 1.0 else values
    return values + offset if offset else values


def _require_finite(channel: Channel) -> None:
    """Raise InputError for an infinite value of a channel."""
    if not all_finite(channel.values) and (infinite := np.isinf(channel.values)).any():
        first = int(np.argmax(infinite))
        raise InputError(channel.place(first), f"found {channel.values[first]}", "allowed: a finite number")


def _between_known(values: Array) -> Array:
    """Values (n,) with nan filled in by the line between their neighbours."""
    known, place = ~np.isnan(values), np.arange(values.size)
    return np.interp(place, place[known], values[known])


def _known_samples(name: str, sampled: SampledSignal, channel: Channel, notes: list[str]) -> SampledSignal:
    """A signal with its empty cells reported: a few are holes; many mean that it was sampled more slowly."""
    if all_finite(sampled.values):
        return sampled
    unknown, clock = np.isnan(sampled.values), sampled.clock
    count, known = int(unknown.sum()), int((~unknown).sum())
    if known < 2:
        raise InputError(channel.place(), f"found {known} numbers", "allowed: at least two")
    if count > FEW * unknown.size:
        notes.append(f"{name} is given in {known} of {unknown.size} rows; read as sampled there")
        own = Clock(clock.time[~unknown], clock.recorded[~unknown], clock.tick, clock.place)
        return SampledSignal(own, sampled.values[~unknown])
    cells = "1 cell is" if count == 1 else f"{count} cells are"
    first = channel.place(int(np.argmax(unknown)))
    notes.append(f"{cells} empty or no number, the first at {first}: a hole each")
    return replace(sampled, values=_between_known(sampled.values), unknown=unknown)


def _unwrapped(
    name: str, choice: SignalColumn, signals: Mapping[str, SampledSignal], unwrapping: Unwrapping, notes: list[str]
) -> SampledSignal:
    sampled, speed = signals[name], signals.get(name.replace("position", "velocity"))
    speeds = speed.values if speed is not None and speed.clock is sampled.clock else None
    count, place = abs(choice.scale.factor), choice.channel.place
    values, wraps = unwrapping(sampled.values, sampled.clock.time, speeds, count, place)
    if wraps is None:
        return sampled
    notes.append(
        f"{name} wraps {counted(wraps.count, 'time')} by {wraps.period:.6g} {choice.scale.unit}; made continuous"
    )
    return replace(sampled, values=values, wraps=wraps)


def _clock_of(channel: Channel, time: SignalColumn | None, how: ReadingOptions, notes: list[str]) -> Clock:
    """The clock of a channel: its own times, those of its table, `time`, if that has one, or the sample period's."""
    own = channel.time if channel.time is not None else getattr(time, "channel", None)
    period = how.sample_period
    if own is None:
        assert period is not None  # `choose` asks for it where there is no time
        count = np.arange(channel.values.size, dtype=np.float64)
        return Clock(count * period, count, period, channel.place)
    scale = time.scale if time is not None and own is time.channel else scale_in("time", own.unit or "s", own.place())
    _require_finite(own)
    raw = own.values if all_finite(own.values) else _filled(own, notes)
    if scale.unit == "samples":
        assert period is not None
        count = _counts(own, raw)
        return Clock(count * period, count, period, own.place)
    clock = Clock(raw * scale.factor if scale.factor != 1.0 else raw, raw, scale.factor, own.place)
    return clock if period is None else _agreeing(clock, period, own, notes)


def _running_on(clock: Clock, notes: list[str]) -> Clock:
    """The clock of a log whose tool was started again, with what follows each start placed behind a hole."""
    time = clock.time
    back = np.flatnonzero(np.diff(time) < 0) + 1
    parts = np.split(time, back)
    if not back.size or min(part.size for part in parts) <= SHORTEST_PART:
        return clock
    hole = HOLE_OF_START * float(np.median(np.diff(parts[0])))
    if any(part[0] > parts[0][SHORTEST_PART] or part[1] - part[0] > hole for part in parts):
        return clock  # single times that are wrong
    starts = np.cumsum([0.0, *(float(np.ptp(part)) + hole for part in parts[:-1])])
    moved = np.concatenate([part - part[0] + time[0] + start for part, start in zip(parts, starts, strict=True)])
    more = f", and {counted(back.size - 1, 'time')} more" if back.size > 1 else ""
    notes.append(f"{clock.place(int(back[0]))}: the times start again{more}; what follows is placed behind a hole")
    return replace(clock, time=moved)


def _filled(time: Channel, notes: list[str]) -> Array:
    """Times with those that are empty taken from their neighbours."""
    unknown = np.isnan(time.values)
    count, first = int(unknown.sum()), time.place(int(np.argmax(unknown)))
    if count > FEW * unknown.size:
        raise InputError(first, f"found {count} of {unknown.size} times empty", f"allowed: {percent(FEW)} of them")
    notes.append(f"{counted(count, 'time')} empty, the first at {first}; taken from their neighbours")
    return _between_known(time.values)


def _counts(time: Channel, index: Array) -> Array:
    """Samples from the first by an index (n,) that counts them, whatever its usual step."""
    steps = np.diff(index)
    if index.size < 2 or not (steps > 0).all():
        first = int(np.argmax(steps <= 0)) + 1 if index.size > 1 else 0
        raise InputError(time.place(first), "the sample index does not increase", "allowed: an increasing index")
    return (index - index[0]) / float(np.median(steps))


def _agreeing(clock: Clock, period: float, time: Channel, notes: list[str]) -> Clock:
    """The clock, checked against the rig's sample period; times by that period if the clock is too coarse."""
    steps = np.diff(clock.time)
    coarse = steps.size > 0 and float(np.mean(steps == 0.0)) > FEW
    mean = float(clock.time[-1] - clock.time[0]) / max(steps.size, 1)
    slack = float(steps.max(initial=0.0)) / max(steps.size, 1) if coarse else PERIOD * period
    typical = mean if coarse else float(np.median(steps)) if steps.size else period
    if abs(typical - period) > slack + PERIOD * period:
        found = f"steps by {typical:.6g} s, where the rig's [trace] has sample_period = {period:.6g} s"
        raise InputError(
            time.place(),
            found,
            f'allowed: in the rig, `[trace] sample_period = "{typical:.6g} s"`, or a file with its period',
        )
    if not coarse:
        return clock
    notes.append(f"times are too coarse to distinguish samples; read as every {period:g} s, as in the rig")
    count = np.arange(clock.time.size, dtype=np.float64)
    return Clock(clock.time[0] + count * period, count, period, clock.place)
