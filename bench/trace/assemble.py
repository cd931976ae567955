"""From a recording to a trace: which channel is which signal, in SI units, on one regular time base."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import Array
from bench.errors import InputError
from bench.trace.channel import Channel, Recording, split_label
from bench.trace.clock import Clock, Sampled
from bench.trace.known_names import checked_si_unit, signal_of, unit_of
from bench.trace.signals import SI_UNITS
from bench.trace.time_base import regular
from bench.trace.trace import Trace, all_finite
from bench.units import convert, nearest


@dataclass(frozen=True)
class Chosen:
    """The channel that holds a signal.

    Attributes:
        channel: as the reader returned it.
        unit: of its values, from the file, the rig's columns or a reported assumption.
        sign: +1 or -1, by which values are multiplied.
    """

    channel: Channel
    unit: str | None
    sign: float = 1.0


def assemble(recording: Recording, columns: Mapping[str, str] | None = None) -> Trace:
    """Trace of a recording.

    Args:
        recording: as a reader returned it.
        columns: signal (or `time`) -> column of the file with unit, e.g. `{"velocity": "-Axis1.ActVel [mm/s]"}`; a
            leading `-` turns the sign. Signals not named here are taken from columns with well-known names.

    Raises:
        InputError: a column missing, ambiguous, without unit or of the wrong dimension; no time; values that are not
            finite; times that run backwards or stand twice too often.
    """
    chosen, notes = choose(recording, columns or {})
    signals, units = in_si(chosen, recording)
    dropped = unused(chosen, recording)
    used = regular(signals)
    metadata = {**recording.metadata, "format": recording.format}
    if dropped:
        metadata["dropped_columns"] = ", ".join(dropped)
    return Trace(
        time=used.time,
        signals=used.signals,
        units=units,
        origin=recording.origin,
        metadata=metadata,
        time_base=used.time_base,
        notes=(*recording.notes, *notes, *used.notes),
        wraps=used.wraps,
    )


def choose(recording: Recording, columns: Mapping[str, str]) -> tuple[dict[str, Chosen], tuple[str, ...]]:
    """Channel of every signal, `time` among them where the recording is a table, and what had to be assumed."""
    for signal in columns:
        if signal not in SI_UNITS and signal != "time":
            raise InputError(
                f"columns: {signal}",
                f"not a signal{nearest(signal, [*SI_UNITS])}",
                f"allowed: time, {', '.join(SI_UNITS)}",
            )
    chosen: dict[str, Chosen] = {}
    notes: list[str] = []
    for signal in ("time", *SI_UNITS):
        named = _named(recording, signal, columns[signal]) if signal in columns else None
        found = named or _known(recording, signal)
        if found is None and signal in columns:
            raise _missing(recording, f"column '{columns[signal].strip().lstrip('-')}'")
        if found is None:
            continue
        if named is None and signal in columns:
            notes.append(f"{signal} read from '{found.channel.label}', as the file has no '{columns[signal]}'")
        usual = recording.usual_units.get(signal)
        if found.unit is None and usual is not None:
            found = replace(found, unit=usual)
            notes.append(f"{signal} taken as {usual}, as the file tells no unit")
        elif named is not None and unit_of(found.channel.unit) not in (None, found.unit):
            notes.append(f"{signal} read in {found.unit}, as the rig says, where the file says {found.channel.unit}")
        chosen[signal] = found
    return chosen, tuple(notes)


def unused(chosen: Mapping[str, Chosen], recording: Recording) -> list[str]:
    """Names of the channels that are no signal of the trace."""
    used = {id(choice.channel) for choice in chosen.values()}
    return [channel.label for channel in recording.channels if id(channel) not in used]


def _named(recording: Recording, signal: str, text: str) -> Chosen | None:
    """Channel that a rig's column text names; None when no such name is in the file."""
    text = text.strip()
    name, unit = split_label(text.removeprefix("-"))
    for key in (str, str.lower, lambda label: label.lower().rsplit(".", 1)[-1]):
        matches = [channel for channel in recording.channels if key(channel.name) == key(name)]
        if len(matches) > 1:
            raise _ambiguous(recording, signal, matches)
        if matches:
            return Chosen(matches[0], unit_of(unit or matches[0].unit), -1.0 if text.startswith("-") else 1.0)
    return None


def _known(recording: Recording, signal: str) -> Chosen | None:
    matches = [channel for channel in recording.channels if channel.name == signal]
    matches = matches or [channel for channel in recording.channels if signal_of(channel.name) == signal]
    if len(matches) > 1:
        raise _ambiguous(recording, signal, matches)
    return Chosen(matches[0], unit_of(matches[0].unit)) if matches else None


def _ambiguous(recording: Recording, signal: str, matches: list[Channel]) -> InputError:
    names = ", ".join(f"'{channel.label}'" for channel in matches)
    return InputError(
        f"{recording.origin}: {signal}",
        f"found several columns for it ({names})",
        "name one in the rig's [trace.columns]",
    )


def _missing(recording: Recording, what: str) -> InputError:
    labels = [channel.label for channel in recording.channels]
    shown = ", ".join(labels[:12]) + (f" and {len(labels) - 12} more" if len(labels) > 12 else "")
    return InputError(f"{recording.origin}: {what}", "not in the file", f"found: {shown or 'no column'}")


def in_si(chosen: Mapping[str, Chosen], recording: Recording) -> tuple[dict[str, Sampled], dict[str, str]]:
    """Signals in SI units with the clock each was sampled by, and their units.

    Raises:
        InputError: no time, no signal, a unit missing or wrong, a value that is not finite, or lengths that differ.
    """
    units = {name: _si_unit(name, choice, recording) for name, choice in chosen.items()}
    _one_kind_of_axis(units, recording)
    clocks: dict[int, Clock] = {}
    signals: dict[str, Sampled] = {}
    for name, choice in chosen.items():
        if name == "time":
            continue
        time = (
            Chosen(choice.channel.time, unit_of(choice.channel.time.unit))
            if choice.channel.time
            else chosen.get("time")
        )
        if time is None:
            raise _missing(recording, "column 'time'")
        clock = clocks.setdefault(id(time.channel), _clock(time, recording))
        values = _values(choice, units[name])
        if values.size != clock.time.size:
            raise InputError(
                choice.channel.place(), f"found {values.size} values", f"allowed: {clock.time.size}, as its time has"
            )
        signals[name] = Sampled(clock, values)
    if not signals:
        raise _missing(recording, "position or velocity")
    return signals, {name: unit for name, unit in units.items() if name != "time"}


def _si_unit(name: str, choice: Chosen, recording: Recording) -> str:
    if choice.unit is None:
        raise InputError(
            choice.channel.place(),
            choice.channel.open_unit or "has no unit",
            f'allowed: a unit in the file, or {name} = "{choice.channel.name} [unit]" in the rig\'s [trace.columns]',
        )
    return checked_si_unit(name, choice.unit, f"{recording.origin}: column '{choice.channel.label}'")


def _one_kind_of_axis(units: Mapping[str, str], recording: Recording) -> None:
    moving = {
        name: unit for name, unit in units.items() if len(set(SI_UNITS.get(name, ("",)))) == 2 and "N" not in unit
    }
    if len({unit.startswith("m") for name, unit in moving.items() if unit != "dimensionless"}) > 1:
        found = ", ".join(f"{name} in {unit}" for name, unit in moving.items())
        raise InputError(recording.origin, f"found {found}", "allowed: all of a rotary axis or all of a linear one")


def _clock(time: Chosen, recording: Recording) -> Clock:
    unit = _si_unit("time", time, recording)
    raw = time.channel
    return Clock(_values(time, unit), raw.values, _scale(time.unit or unit), raw.place)


def _scale(unit: str) -> float:
    return float(convert(np.ones(1), unit, "s")[0])


def _values(choice: Chosen, unit: str) -> Array:
    channel = choice.channel
    if channel.defect is not None:
        raise channel.defect
    if not all_finite(channel.values):
        first = int(np.argmin(np.isfinite(channel.values)))
        raise InputError(channel.place(first), f"found {channel.values[first]}", "allowed: a finite number")
    values = convert(channel.values, choice.unit or unit, unit)
    return values if choice.sign > 0 else -values
