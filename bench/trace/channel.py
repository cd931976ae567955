"""What a reader returns: the channels of a recording as they stand in the file, before any mapping to signals."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bench.arrays import Array
from bench.errors import InputError
from bench.names import nearest, short
from bench.trace.signals import unit_in_name

#: Format of a recording that is given as arrays or a data frame.
ARRAYS = "arrays"
_ELEMENT = re.compile(r"\S\[\d+\]")
#: Names of the two columns of a time stamp, which ROS and C's `timespec` have in whole seconds and nanoseconds.
_WHOLE = re.compile(r"(?:(.*)[^a-z0-9])?(?:tv_)?secs?", re.IGNORECASE)
_PART = re.compile(r"(?:(.*)[^a-z0-9])?(?:tv_)?n(?:ano)?secs?", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class Channel:
    """One column of numbers in a recording.

    Attributes:
        name: as in the file, without its unit.
        unit: as in the file; None where the file has none.
        values: in that unit - (n,).
        origin: file it is in.
        time: channel with its sample times; None in a table, whose time is one of its columns. Channels sampled
            together share the same object.
        line: line of the file of the first value, where one line is one sample.
        start: number of the first value among the file's samples.
        defect: why the values cannot be read; raised only where a trace needs them.
        open_unit: why the unit is not determined though it names one.
        axis: of a file with several.
        signal: that it is of that axis, by its name (`bench.trace.joints`).
        number: of its column in the file, from 1, where it has one.
        moments: whether the values are moments of a calendar or a clock, as times from the first of them.
    """

    name: str
    unit: str | None
    values: Array
    origin: str
    time: Channel | None = None
    line: int | None = None
    start: int = 0
    defect: InputError | None = None
    open_unit: str | None = None
    axis: str | None = None
    signal: str | None = None
    moments: bool = False
    number: int | None = None

    @property
    def label(self) -> str:
        """Name with unit, as in a column's head."""
        return self.name if self.unit is None else f"{self.name} [{self.unit}]"

    def place(self, sample: int | None = None) -> str:
        """Where a value is, for messages: file, line (or sample, counted from 0) and column."""
        if sample is None:
            return f"{self.origin}: column '{short(self.label)}'"
        row = f"sample {self.start + sample}" if self.line is None else f"line {self.line + sample}"
        return f"{self.origin}: {row}, column '{short(self.label)}'"


@dataclass(frozen=True, eq=False)
class Recording:
    """The contents of one file.

    Attributes:
        channels: in the file's order.
        format: the file's format in words.
        origin: the file.
        metadata: what the file states about itself.
        notes: what the reader did or left out that the user should know.
        usual_units: units of well-known signals in files of this kind, which carry none; used as a reported
            assumption.
    """

    channels: tuple[Channel, ...]
    format: str
    origin: str
    metadata: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    usual_units: Mapping[str, str] = field(default_factory=dict)

    def stated(self, units: Mapping[str, str] | None) -> Recording:
        """The same with units of columns by their names, which replace those of the file.

        Raises:
            InputError: a column that is not there.
        """
        names = [channel.name for channel in self.channels]
        for name in units or {}:
            if name not in names:
                found = f"no such column{nearest(str(name), names)}"
                raise InputError(f"{self.origin}: unit of {name}", found, f"found: {', '.join(map(short, names))}")
        if not units:
            return self
        return replace(self, channels=tuple(replace(one, unit=units.get(one.name, one.unit)) for one in self.channels))

    def column(self, channel: Channel) -> str:
        """What `[trace.columns]` calls a column: its name, or its number where another has the same name."""
        if sum(one.name == channel.name for one in self.channels) < 2:
            return channel.name
        numbers = (one.number or place for place, one in enumerate(self.channels, 1) if one is channel)
        return f"column {next(numbers)}"

    def stating(self, signal: str, channel: Channel, unit: str) -> str:
        """What a user writes to state the unit of a column."""
        if self.format == ARRAYS:
            return f'units={{"{channel.name}": "{unit}"}}'
        return f'`[trace.columns] {signal} = "{self.column(channel)} [{unit}]"` in the rig'


def with_stamps(channels: Sequence[Channel]) -> tuple[Channel, ...]:
    """The same, whole seconds and the nanoseconds beyond them as one time from the first sample."""
    whole, part = (
        {match[1]: one for one in channels if (match := name.fullmatch(one.name)) and one.values.size}
        for name in (_WHOLE, _PART)
    )
    joined: dict[Channel, Channel | None] = {}
    for prefix in whole.keys() & part.keys():
        one, other = whole[prefix], part[prefix]
        if not (one.values % 1.0).any() and 0.0 <= other.values.min() <= other.values.max() < 1e9:
            passed = one.values - one.values[0] + 1e-9 * other.values
            joined |= {one: replace(one, name=prefix or "time", unit="s", values=passed, moments=True), other: None}
    return tuple(kept for one in channels if (kept := joined.get(one, one)) is not None)


def with_shared_times(channels: Iterable[Channel]) -> tuple[Channel, ...]:
    """The same channels, those whose sample times are equal sharing one time channel."""
    times: list[Channel] = []
    shared: list[Channel] = []
    for channel in channels:
        if (own := channel.time) is not None:
            time = next((known for known in times if np.array_equal(known.values, own.values)), own)
            times += [time] if time is own else []
            channel = replace(channel, time=time)
        shared.append(channel)
    return tuple(shared)


def with_units(channels: Sequence[Channel]) -> tuple[Channel, ...]:
    """The same channels, each without a unit with the one in its name, as `velocity_rad_s` has it."""
    bare = {channel for channel in channels if channel.unit is None and channel.open_unit is None}
    return tuple(replace(one, unit=unit_in_name(one.name)[1]) if one in bare else one for one in channels)


def split_label(label: str) -> tuple[str, str | None]:
    """Name and unit of a column head `name [unit]`; no unit gives None. `name[0]` is a name, of an element."""
    label = label.strip()
    start = label.rfind("[")
    if start < 0 or not label.endswith("]") or "]" in label[start:-1] or _ELEMENT.fullmatch(label[start - 1 :]):
        return label, None
    return label[:start].strip(), label[start + 1 : -1].strip() or None
