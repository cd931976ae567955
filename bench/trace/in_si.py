"""Chosen channels in SI units, each with the clock it was sampled by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import Array
from bench.errors import InputError
from bench.trace.channel import Channel, Recording
from bench.trace.choose import Chosen, missing
from bench.trace.clock import Clock, Sampled
from bench.trace.reading_options import ReadingOptions
from bench.trace.signal_names import scale_in
from bench.trace.signals import SI_UNITS
from bench.trace.trace import all_finite
from bench.trace.wraps import Unwrapping, Wraps

#: Share of cells that may be empty as lost samples; a column with more of them is sampled by a clock of its own.
FEW = 0.05
#: Share by which the sample period of a rig may differ from the mean step of the times in the file.
PERIOD = 0.01


@dataclass(frozen=True)
class InSI:
    """Signals in SI units with the clock each was sampled by, their units, what the user should know, and wraps
    of the position that were undone."""

    signals: dict[str, Sampled]
    units: dict[str, str]
    notes: tuple[str, ...] = ()
    wraps: Wraps | None = None


def in_si(
    chosen: Mapping[str, Chosen],
    recording: Recording,
    how: ReadingOptions,
    wrapping: dict[str, Unwrapping] | None = None,
) -> InSI:
    """Bring chosen channels to SI.

    Args:
        chosen: by signal.
        recording: whose channels they are.
        how: it is to be read.
        wrapping: what was found of positions in the pieces before, where a recording is read in pieces.

    Raises:
        InputError: no signal, an infinite value, hardly a number, lengths that differ, times that the sample period
            contradicts, or a position that wraps by an unknown period.
    """
    units = {name: choice.scale.unit for name, choice in chosen.items() if name != "time"}
    _one_kind_of_axis(units, recording)
    if not units:
        raise missing(recording, "position or velocity", "map them in the rig's [trace.columns]")
    notes: list[str] = []
    clocks: dict[int, Clock] = {}
    signals: dict[str, Sampled] = {}
    for name in units:
        choice = chosen[name]
        channel = choice.channel
        time = channel.time if channel.time is not None else getattr(chosen.get("time"), "channel", None)
        if id(time) not in clocks:
            clocks[id(time)] = _clock(time, chosen.get("time"), channel, how, recording, notes)
        clock, values = clocks[id(time)], _values(choice)
        if values.size != clock.time.size:
            raise InputError(
                channel.place(), f"found {values.size} values", f"allowed: {clock.time.size}, as its time has"
            )
        signals[name] = _known_samples(name, Sampled(clock, values), channel, notes)
    wraps: Wraps | None = None
    for name in ("position", "position_reference"):
        if name in signals:
            unwrapping = (wrapping if wrapping is not None else {}).setdefault(name, Unwrapping(how.position_period))
            signals[name], undone = _unwrapped(name, chosen[name], signals, unwrapping, notes)
            wraps = undone if name == "position" else wraps
    return InSI(signals, units, tuple(notes), wraps)


def _one_kind_of_axis(units: Mapping[str, str], recording: Recording) -> None:
    moving = {
        name: unit for name, unit in units.items() if len(set(SI_UNITS.get(name, ("",)))) == 2 and "N" not in unit
    }
    if len({unit.startswith("m") for name, unit in moving.items() if unit != "dimensionless"}) > 1:
        found = ", ".join(f"{name} in {unit}" for name, unit in moving.items())
        raise InputError(recording.origin, f"found {found}", "allowed: all of a rotary axis or all of a linear one")


def _values(choice: Chosen) -> Array:
    channel, scale = choice.channel, choice.scale
    values = channel.values
    if not all_finite(values) and np.isinf(values).any():
        first = int(np.argmax(np.isinf(values)))
        raise InputError(channel.place(first), f"found {values[first]}", "allowed: a finite number")
    factor = choice.sign * scale.factor
    if factor != 1.0:
        values = values * factor
    return values + choice.sign * scale.offset if scale.offset else values


def _known_samples(name: str, sampled: Sampled, channel: Channel, notes: list[str]) -> Sampled:
    """A signal with its empty cells told: a few are holes; many mean that it was sampled more slowly."""
    if all_finite(sampled.values):
        return sampled
    unknown = np.isnan(sampled.values)
    count, clock = int(unknown.sum()), sampled.clock
    if unknown.size - count < 2:
        raise InputError(channel.place(), f"found {unknown.size - count} numbers", "allowed: at least two")
    if count > FEW * unknown.size:
        notes.append(f"{name} stands in {unknown.size - count} of {unknown.size} rows; read as sampled there")
        own = Clock(clock.time[~unknown], clock.recorded[~unknown], clock.tick, clock.place)
        return Sampled(own, sampled.values[~unknown])
    cells = "1 cell is" if count == 1 else f"{count} cells are"
    first = channel.place(int(np.argmax(unknown)))
    notes.append(f"{cells} empty or no number, the first at {first}: a hole each")
    place = np.arange(unknown.size)
    filled = np.interp(place, place[~unknown], sampled.values[~unknown])
    return replace(sampled, values=filled, unknown=unknown)


def _clock(
    time: Channel | None,
    chosen: Chosen | None,
    channel: Channel,
    how: ReadingOptions,
    recording: Recording,
    notes: list[str],
) -> Clock:
    """The clock of a channel: its own times, those of the table, or the sample period's."""
    if time is None:
        period = how.sample_period
        assert period is not None  # choose asks for it where there is no time
        count = np.arange(channel.values.size, dtype=np.float64)
        return Clock(count * period, count, period, channel.place)
    scale = chosen.scale if chosen is not None and time is chosen.channel else None
    if scale is None:
        scale = scale_in("time", time.unit or "s", time.place())
    raw = time.values
    if not np.isfinite(raw).all():
        if np.isinf(raw).any():
            first = int(np.argmax(np.isinf(raw)))
            raise InputError(time.place(first), f"found {raw[first]}", "allowed: a finite number")
        raw = _filled_times(time, notes)
    if scale.unit == "samples":
        return _counted(time, raw, how)
    clock = Clock(raw * scale.factor if scale.factor != 1.0 else raw, raw, scale.factor, time.place)
    return clock if how.sample_period is None else _agreeing(clock, how.sample_period, time, notes)


def _filled_times(time: Channel, notes: list[str]) -> Array:
    """Times with those that are empty taken from their neighbours."""
    unknown = np.isnan(time.values)
    count = int(unknown.sum())
    if count > FEW * unknown.size:
        place = time.place(int(np.argmax(unknown)))
        raise InputError(place, f"found {count} of {unknown.size} times empty", f"allowed: {FEW:.0%} of them")
    notes.append(
        f"{count} times empty, the first at {time.place(int(np.argmax(unknown)))}; taken from their neighbours"
    )
    place = np.arange(unknown.size)
    return np.interp(place, place[~unknown], time.values[~unknown])


def _counted(time: Channel, raw: Array, how: ReadingOptions) -> Clock:
    """Times of a sample index."""
    assert how.sample_period is not None
    steps = np.diff(raw)
    if raw.size < 2 or not (steps > 0).all():
        first = int(np.argmax(steps <= 0)) + 1 if raw.size > 1 else 0
        raise InputError(time.place(first), "the sample index does not increase", "allowed: an increasing index")
    count = (raw - raw[0]) / float(np.median(steps))
    return Clock(count * how.sample_period, count, how.sample_period, time.place)


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


def _unwrapped(
    name: str, choice: Chosen, signals: Mapping[str, Sampled], unwrapping: Unwrapping, notes: list[str]
) -> tuple[Sampled, Wraps | None]:
    sampled = signals[name]
    speed = signals.get(name.replace("position", "velocity"))
    speeds = speed.values if speed is not None and speed.clock is sampled.clock else None
    values, wraps = unwrapping(
        sampled.values, sampled.clock.time, speeds, abs(choice.scale.factor), choice.channel.place
    )
    if wraps is None:
        return sampled, None
    notes.append(f"{name} wraps {wraps.count} times by {wraps.period:.6g} {choice.scale.unit}; made continuous")
    return replace(sampled, values=values), wraps
