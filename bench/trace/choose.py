"""Which channel of a recording is which signal: by the rig's columns first, by what else speaks for it second."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from bench.errors import InputError
from bench.names import nearest, short
from bench.trace.assumed import Assumption, assumed_units
from bench.trace.candidates import MAYBE, SURE, LikelySignal, candidates
from bench.trace.channel import Channel, Recording, split_label
from bench.trace.signals import SI_UNITS, is_index, plain_name, scale_in, signal_of, unit_of, wanted_units
from bench.units.conversion import UnitScale, scale_of, scale_or_none
from bench.units.grammar import UnitError

#: Signals of which one that can be read is enough: the others are then left out where they cannot.
ENOUGH = (("velocity", "position"), ("torque", "force", "current"))
#: Signals of which a rig that names one names all that are read; other columns then count by a well-known name only.
GROUPS = (("velocity", "position", "acceleration"), ENOUGH[1])
#: Weight by which one column has to be preferred to another.
PLAIN = 0.5
#: Difference of two columns of one signal, as share of its spread, up to which they are one: a filter, a resolution.
SAME = 0.1
_INDEX = UnitScale("samples", 1.0)


class ReadingOptions(Protocol):
    """Options for reading a recording; a rig's `[trace]` has them."""

    @property
    def columns(self) -> Mapping[str, str]:
        """Signal (or `time`) -> column of the file with unit; a leading `-` inverts the sign."""
        ...

    @property
    def sample_period(self) -> float | None:
        """Sample period of a file without times, or with a sample index - s."""
        ...

    @property
    def position_period(self) -> float | None:
        """Period by which the position wraps - rad (m)."""
        ...

    @property
    def axis(self) -> str | None:
        """Axis to read from a file with several."""
        ...


@dataclass(frozen=True)
class GivenOptions:
    """Options without a rig."""

    columns: Mapping[str, str] = field(default_factory=dict)
    sample_period: float | None = None
    position_period: float | None = None
    axis: str | None = None


def reading_options(given: Mapping[str, str] | ReadingOptions | None) -> ReadingOptions:
    """Options as they are, from columns alone, or empty."""
    if given is None:
        return GivenOptions()
    return GivenOptions(given) if isinstance(given, Mapping) else given


@dataclass(frozen=True)
class SignalColumn:
    """The channel of a signal.

    Attributes:
        channel: as the reader returned it.
        scale: how its numbers become SI; in `samples` where they only count them.
        sign: +1 or -1, by which values are multiplied.
        usual: unit that was taken where the file has none; None where it has.
    """

    channel: Channel
    scale: UnitScale
    sign: float = 1.0
    usual: str | None = None


def choose(recording: Recording, how: ReadingOptions) -> tuple[dict[str, SignalColumn], tuple[str, ...]]:
    """Channel of every signal, `time` among them where the recording is a table, and what had to be assumed.

    Raises:
        InputError: a column that the rig names is missing, ambiguous, or has no unit or a wrong one; or none of those
            that a trace needs can be read.
    """
    for signal in how.columns:
        if signal not in SI_UNITS and signal != "time":
            allowed = f"allowed: time, {', '.join(SI_UNITS)}"
            raise InputError(f"columns: {signal}", f"not a signal{nearest(signal, [*SI_UNITS])}", allowed)
    whole, recording = recording, replace(recording, channels=of_axis(recording, how.axis))
    known = likely(recording, how.columns)
    columns: dict[str, _Chosen] = {}
    chosen: dict[str, SignalColumn] = {}
    faults: dict[str, InputError] = {}
    notes: list[str] = []
    for signal in ("time", *SI_UNITS):
        with _fault_of(signal, faults, how):
            column = _column(recording, whole, signal, how.columns, known, notes)
            columns |= {signal: column} if column is not None else {}
    assumption = _assumption(columns, whole, how, known)
    for signal, column in columns.items():
        with _fault_of(signal, faults, how):
            chosen[signal] = column.scaled(signal, assumption, recording)
            notes += [f"{signal}: {note}"] if (note := chosen[signal].scale.note) else []
    _require(recording, chosen, faults, how)
    if "time" not in chosen and how.sample_period is not None:
        index = _index(recording, how.columns)
        chosen |= {"time": SignalColumn(index, _INDEX)} if index is not None else {}
    left = (f"{signal} left out: {fault.where} {fault.found}" for signal, fault in faults.items() if signal != "time")
    return chosen, (*assumed_note(chosen, recording), *notes, *left)


def of_axis(recording: Recording, axis: str | None) -> tuple[Channel, ...]:
    """Channels of one axis, and those that belong to none; all where no axis is asked for.

    Raises:
        InputError: the recording has no such axis.
    """
    if axis is None:
        return recording.channels
    axes = axes_of(recording.channels)
    if axis in axes:
        return tuple(channel for channel in recording.channels if channel.axis in (axis, None))
    parts = [channel for channel in recording.channels if axis.lower() in channel.name.lower().split(".")]
    if parts:
        others = [channel for channel in recording.channels if channel not in parts]
        times = [one for one in others if signal_of(one.name) == "time" or is_index(one.name) or "." not in one.name]
        return (*parts, *times)
    found = f"no axis '{axis}'{nearest(axis, list(axes))}"
    raise InputError(recording.origin, found, f"found: {', '.join(axes) or 'one axis without a name'}")


def axes_of(channels: Iterable[Channel]) -> tuple[str, ...]:
    """Names of the axes of a recording, in its order."""
    return tuple(dict.fromkeys(channel.axis for channel in channels if channel.axis is not None))


def _require(
    recording: Recording, chosen: Mapping[str, SignalColumn], faults: dict[str, InputError], how: ReadingOptions
) -> None:
    """Raise the first fault by which a trace lacks what it needs."""
    timed = "time" in chosen or any(choice.channel.time is not None for choice in chosen.values())
    if not timed and how.sample_period is None:
        if "time" in faults:
            raise faults["time"]
        if chosen:
            advice = 'give its period in the rig, e.g. `[trace] sample_period = "1 ms"`, or map its column'
            raise missing(recording, "column 'time'", advice)
    for group in ENOUGH:
        found = [faults[signal] for signal in group if signal in faults]
        if found and not any(signal in chosen for signal in group):
            raise found[0]


def likely(recording: Recording, columns: Mapping[str, str]) -> dict[Channel, LikelySignal]:
    """The columns that are read in addition to those that a rig names, the best first."""
    found = candidates(recording.channels)
    several = len(axes_of(recording.channels)) > 0
    sure = {one.signal for one in found.values() if one.known or one.weight >= SURE}
    named = {signal for signal in columns if signal != "time"}

    def is_read(channel: Channel, one: LikelySignal) -> bool:
        group = next((group for group in GROUPS if one.signal in group), ())
        if one.known:
            return True
        if one.signal == "time":
            return one.weight >= SURE
        if named.intersection(group) if group else named or (several and channel.axis is None):
            return False
        return one.weight >= (MAYBE if group and sure.isdisjoint(group) else SURE)

    return {channel: one for channel, one in found.items() if is_read(channel, one)}


@dataclass(frozen=True)
class _Chosen:
    """A channel that was chosen for a signal.

    Attributes:
        channel: as the reader returned it.
        unit: that the rig or the file states; None where neither does.
        usual: unit of this signal in files of this kind, which carry none.
        sign: +1 or -1.
    """

    channel: Channel
    unit: str | None
    usual: str | None
    sign: float

    def scaled(self, signal: str, assumption: Assumption, recording: Recording) -> SignalColumn:
        """The same with its scale; InputError where its unit is none of the signal's, or unknown."""
        channel, usual = self.channel, assumption.units.get(signal) or self.usual
        if channel.moments:
            return SignalColumn(channel, scale_in(signal, channel.unit or "s", channel.place()), self.sign)
        reason, example = assumption.refused.get(signal, ("", wanted_units(signal)[0]))
        line = recording.stating(signal, channel, example)
        unit = self.unit or usual
        if unit is None:
            found = channel.open_unit or f"has no unit{f', {reason}' if reason else ''}"
            raise InputError(channel.place(), found, f"allowed: a unit in the file, or e.g. {line}")
        try:
            scale = scale_of(unit, wanted_units(signal))
        except UnitError as error:
            line = recording.stating(signal, channel, error.example or example)
            raise InputError(channel.place(), error.found, f"{error.allowed}; {line} selects it") from error
        return SignalColumn(channel, scale, self.sign, None if self.unit else usual)


@contextmanager
def _fault_of(signal: str, faults: dict[str, InputError], how: ReadingOptions) -> Iterator[None]:
    """Keep what is wrong with a signal's column; raise it where the rig names that column."""
    try:
        yield
    except InputError as fault:
        if signal in how.columns and not (signal == "time" and how.sample_period):
            raise
        faults[signal] = fault


def _column(
    recording: Recording,
    whole: Recording,
    signal: str,
    columns: Mapping[str, str],
    known: Mapping[Channel, LikelySignal],
    notes: list[str],
) -> _Chosen | None:
    """The channel of a signal, by a column's name of the whole recording's; None where there is none."""
    given, named, unit = columns.get(signal), None, None
    if given is not None:
        name, unit = split_label(given.strip().removeprefix("-"))
        named = _named(recording, signal, name) or _named(whole, signal, name)
    channel = named or _known(recording, signal, known)
    if channel is None:
        if given is not None:
            raise missing(recording, f"column '{given.strip().lstrip('-')}'")
        return None
    if named is None and given is not None:
        notes.append(f"{signal} read from '{channel.label}', as the file has no '{given}'")
        unit = None
    if channel.defect is not None:
        raise channel.defect
    candidate = None if named is not None else known[channel]
    own, stated = unit_of(channel.unit), unit_of(unit or channel.unit)
    scales = [scale_or_none(one or "", wanted_units(signal)) for one in (own, stated)]
    if named is not None and unit is not None and not channel.moments and own is not None and scales[0] != scales[1]:
        notes.append(f"{signal} read in {unit}, as in the rig, where the file has {channel.unit}")
    inverted = named is not None and str(given).strip().startswith("-")
    stated, usual = stated or (candidate.unit if candidate is not None else None), None
    if stated is None and not channel.moments:
        usual = candidate.usual if candidate is not None else None
        usual = recording.usual_units.get(signal, usual) if candidate is None or candidate.known else usual
    return _Chosen(channel, stated, usual, -1.0 if inverted else 1.0)


def _assumption(
    columns: Mapping[str, _Chosen], recording: Recording, how: ReadingOptions, known: Mapping[Channel, LikelySignal]
) -> Assumption:
    """Units of the columns without one; none where the file names a unit that is ambiguous.

    Nor where the format has units of its own: variables of a PLC program are in whatever its author chose.
    """
    own = {one for one, of in known.items() if recording.usual_units and not of.known}
    time = columns["time"].channel if "time" in columns else None
    bare = all(unit_of(one.unit) is None for one in recording.channels if one is not time)
    open_to = {
        signal: column
        for signal, column in columns.items()
        if column.channel.open_unit is None
        and column.channel not in own
        and not (signal == "time" and how.sample_period)
    }
    units = {
        signal: (one.channel.unit or "s") if one.channel.moments else one.unit or one.usual
        for signal, one in open_to.items()
    }
    if time is not None and "time" in units and not time.moments:
        units["time"] = columns["time"].unit  # the usual one, unless motion determines another
    return assumed_units({signal: column.channel for signal, column in open_to.items()}, units, bare)


def assumed_note(chosen: Mapping[str, SignalColumn], recording: Recording) -> tuple[str, ...]:
    """The note on units that were assumed, one line with what to write where one is wrong; else none."""
    taken = {signal: one for signal, one in chosen.items() if one.usual is not None}
    if not taken:
        return ()
    read = ", ".join(f"{signal} taken as {one.usual}" for signal, one in taken.items())
    signal, one = next(reversed(taken.items()))
    line = recording.stating(signal, one.channel, str(one.usual))
    return (f"{read}, as the file has no unit; to state another: {line}",)


def _named(recording: Recording, signal: str, name: str) -> Channel | None:
    """Channel that a rig's column text names; None when no such name is in the file."""
    for key in (str, str.lower, _without_marks, plain_name):
        matches = [channel for channel in recording.channels if key(channel.name) == key(name)]
        if matches:
            return _one(recording, signal, matches)
    numbered = re.fullmatch(r"column ([1-9]\d{0,4})", name)
    places = enumerate(recording.channels, 1) if numbered else ()
    return next((one for place, one in places if (one.number or place) == int(name.split()[1])), None)


def _without_marks(name: str) -> str:
    """A name without what comments, topics and paths put around it; parts of a path between dots."""
    return name.strip("#%/ ").removesuffix(".data").replace("/", ".").lower()


def _known(recording: Recording, signal: str, known: Mapping[Channel, LikelySignal]) -> Channel | None:
    """The column that is most likely a signal; None where there is none. InputError where several are as likely."""
    matches = {channel: one.weight for channel, one in known.items() if one.signal == signal}
    if not matches:
        return None
    best = max(matches, key=lambda channel: (matches[channel], channel.name == signal))
    alike = [channel for channel, weight in matches.items() if matches[best] - weight < PLAIN]
    others = (one for one in alike if one is not best)
    unlike = [one for one in others if one.axis != best.axis or one.name == best.name or _differ(signal, best, one)]
    return _one(recording, signal, [best, *unlike])


def _differ(signal: str, one: Channel, other: Channel) -> bool:
    """Whether two columns of one signal are two signals; where one of them cannot be read, the other is it."""
    if other is one or signal == "time" or {one.defect, other.defect} != {None} or one.values.size != other.values.size:
        return False
    scale, scale_too = (scale_or_none(channel.unit or "", wanted_units(signal)) for channel in (one, other))
    if scale is None or scale_too is None:
        return False
    ours, theirs = one.values * scale.factor, other.values * scale_too.factor
    both = np.isfinite(ours) & np.isfinite(theirs)
    return bool(both.any()) and float(np.std((ours - theirs)[both])) > SAME * float(np.std(ours[both]))


def _one(recording: Recording, signal: str, matches: list[Channel]) -> Channel:
    if len(matches) == 1:
        return matches[0]
    where, axes = f"{recording.origin}: {signal}", axes_of(matches)
    if len(axes) > 1:
        found = f"found {len(axes)} axes ({', '.join(map(short, axes))})"
        raise InputError(where, found, f"pick one: `{shlex.join(['--axis', axes[0]])}`")
    names = ", ".join(f"'{channel.label}'" for channel in matches)
    line = recording.stating(signal, matches[0], matches[0].unit or wanted_units(signal)[0])
    raise InputError(where, f"found several columns for it ({names})", f"name one: {line}")


def _index(recording: Recording, columns: Mapping[str, str]) -> Channel | None:
    """The column that counts samples: a time without a unit, or a column of such a name."""
    given = columns.get("time")
    named = _named(recording, "time", split_label(given)[0]) if given is not None else None
    if named is not None and named.defect is None:
        return named
    for channel in recording.channels:
        counts = signal_of(channel.name) == "time" or is_index(channel.name)
        if counts and channel.time is None and channel.defect is None and not channel.moments:
            return channel
    return None


def missing(recording: Recording, what: str, then: str | None = None) -> InputError:
    """The error for a column that is not in the file."""
    labels = [short(channel.label) for channel in recording.channels[:12]]
    more = len(recording.channels) - len(labels)
    shown = ", ".join(labels) + (f" and {more} more" if more else "")
    found = f"found: {shown or 'no column'}" + (f"; {then}" if then else "")
    return InputError(f"{recording.origin}: {what}", "not in the file", found)
