"""The channels that were chosen in SI units, each with the clock it was sampled by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import Array, all_finite
from bench.errors import InputError
from bench.trace.channel import Channel, Recording
from bench.trace.choose import SignalColumn, missing
from bench.trace.clock import FEW, Clock, SampledSignal, between_known, clock_of, require_finite
from bench.trace.reading_options import ReadingOptions
from bench.trace.signals import SI_UNITS
from bench.trace.wraps import Unwrapping, Wraps


@dataclass(frozen=True)
class InSI:
    """Signals in SI units with the clock each was sampled by, their units, what the user should know, and wraps
    of the position that were undone."""

    signals: dict[str, SampledSignal]
    units: dict[str, str]
    notes: tuple[str, ...] = ()
    wraps: Wraps | None = None


def in_si(
    chosen: Mapping[str, SignalColumn],
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
    signals: dict[str, SampledSignal] = {}
    for name in units:
        choice = chosen[name]
        channel = choice.channel
        if id(channel.time) not in clocks:
            clocks[id(channel.time)] = clock_of(channel, chosen.get("time"), how, notes)
        clock, values = clocks[id(channel.time)], _values(choice)
        if values.size != clock.time.size:
            raise InputError(
                channel.place(), f"found {values.size} values", f"allowed: {clock.time.size}, as its time has"
            )
        signals[name] = _known_samples(name, SampledSignal(clock, values), channel, notes)
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


def _values(choice: SignalColumn) -> Array:
    channel, scale = choice.channel, choice.scale
    values = channel.values
    if not all_finite(values):
        require_finite(channel)
    factor = choice.sign * scale.factor
    if factor != 1.0:
        values = values * factor
    return values + choice.sign * scale.offset if scale.offset else values


def _known_samples(name: str, sampled: SampledSignal, channel: Channel, notes: list[str]) -> SampledSignal:
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
        return SampledSignal(own, sampled.values[~unknown])
    cells = "1 cell is" if count == 1 else f"{count} cells are"
    first = channel.place(int(np.argmax(unknown)))
    notes.append(f"{cells} empty or no number, the first at {first}: a hole each")
    return replace(sampled, values=between_known(sampled.values), unknown=unknown)


def _unwrapped(
    name: str, choice: SignalColumn, signals: Mapping[str, SampledSignal], unwrapping: Unwrapping, notes: list[str]
) -> tuple[SampledSignal, Wraps | None]:
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
