"""The contents of a recording, before it is used: every column with the signal that it is, and why, and what is
read."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType

import numpy as np

from bench.arrays import Array, rms
from bench.errors import InputError
from bench.structured import json_text
from bench.trace.candidates import candidates
from bench.trace.channel import Channel, Recording
from bench.trace.choose import ReadingOptions, SignalColumn, axes_of, choose, of_axis
from bench.trace.in_si import in_si
from bench.trace.signals import scale_in, wanted_units
from bench.trace.trace import on_time_base, unused
from bench.units.conversion import scale_or_none

SCHEMA = "bench.inspect/1"


@dataclass(frozen=True)
class SignalSummary:
    """One signal in numbers.

    Attributes:
        name, unit: of the signal; SI.
        column: of the file it was read from.
        minimum, maximum, rms: of its values - `unit`.
        resolution: smallest step between successive recorded values, unless they are all equal - `unit`.
    """

    name: str
    unit: str
    column: str
    minimum: float
    maximum: float
    rms: float
    resolution: float | None


@dataclass(frozen=True)
class ColumnSummary:
    """One column of the file.

    Attributes:
        name, unit: as in the file.
        axis: of a file with several.
        count: of its numbers.
        minimum, maximum, resolution: of its numbers, in the file's unit; None where it has none, or never changes.
        rate: of its samples, where it has times of its own - Hz.
        signal: that it is read as, or probably is; None if unknown.
        read: whether it is read as that.
        why: the reasons.
        suggestion: line for the rig's `[trace.columns]` that maps it, where its name alone does not.
    """

    name: str
    unit: str | None
    axis: str | None
    count: int
    minimum: float | None
    maximum: float | None
    resolution: float | None
    rate: float | None
    signal: str | None
    read: bool
    why: tuple[str, ...]
    suggestion: str | None


@dataclass(frozen=True)
class Inspection:
    """The contents of a recording; only columns and `asks` if its signals are not clear.

    Attributes:
        origin, format: the file and what it is.
        columns: of the file, in its order.
        axes: of the file.
        asks: why the file cannot be read as it is, and what to write; None if it can.
        samples, segments: on the regular time base, and its stretches between holes.
        start, duration: of the recording - s.
        rate: sample rate - Hz.
        jitter, holes, duplicates, interpolated, resampled, steps: as of `bench.trace.time_base.TimeBase`.
        signals: in the order of `bench.trace.signals`.
        dropped: columns that are no known signal.
        metadata: what the file states about itself.
        notes: what the reader did, assumed or left out.
    """

    origin: str
    format: str
    columns: tuple[ColumnSummary, ...]
    axes: tuple[str, ...]
    asks: str | None
    samples: int | None = None
    segments: int | None = None
    start: float | None = None
    duration: float | None = None
    rate: float | None = None
    jitter: float | None = None
    holes: tuple[tuple[float, float], ...] = ()
    duplicates: int = 0
    interpolated: int = 0
    resampled: bool = False
    steps: tuple[float, float] | None = None
    signals: tuple[SignalSummary, ...] = ()
    dropped: tuple[str, ...] = ()
    metadata: Mapping[str, str] | None = None
    notes: tuple[str, ...] = ()

    @property
    def suggestions(self) -> tuple[str, ...]:
        """Lines for the rig's `[trace.columns]`."""
        return tuple(column.suggestion for column in self.columns if column.suggestion is not None)


def inspect_recording(recording: Recording, how: ReadingOptions) -> Inspection:
    """Look into a recording.

    Raises:
        InputError: a column that the options name is not there, or has no unit. A recording that needs a rig to be read
            is no error here.
    """
    origin, kind, axes, metadata = recording.origin, recording.format, axes_of(recording.channels), recording.metadata
    try:
        chosen, assumed = choose(recording, how)
        notes = [*recording.notes, *assumed]
        sampled = in_si(chosen, recording, how, notes)
        trace = on_time_base(sampled, chosen, recording, notes)
    except InputError as error:
        if how.columns:
            raise
        columns = tuple(_columns(recording, {}, how))
        return Inspection(origin, kind, columns, axes, str(error), metadata=dict(metadata), notes=recording.notes)
    assert trace.time_base is not None  # a trace that was read has one
    base = asdict(trace.time_base)
    return Inspection(
        origin=origin,
        format=kind,
        columns=tuple(_columns(recording, chosen, how)),
        axes=axes,
        asks=None,
        samples=len(trace),
        segments=len(trace.segments),
        start=float(trace.time[0]),
        duration=float(trace.time[-1] - trace.time[0]),
        rate=1.0 / base.pop("sample_period"),
        **base,
        signals=tuple(
            _summary(name, trace.units[name], chosen[name].channel.label, values, sampled[name].values)
            for name, values in trace.signals.items()
        ),
        dropped=tuple(unused(chosen, recording)),
        metadata=dict(metadata),
        notes=trace.notes,
    )


def to_json(inspection: Inspection, more: Mapping[str, object] = MappingProxyType({})) -> str:
    """The inspection as JSON, its fields under their names, and other results on the recording."""
    return json_text({"schema": SCHEMA, **asdict(inspection), "suggestions": inspection.suggestions, **more})


def _summary(name: str, unit: str, column: str, values: Array, recorded: Array) -> SignalSummary:
    largest = float(np.abs(values).max())
    effective = largest * rms(values / largest) if largest > 0.0 else 0.0
    return SignalSummary(name, unit, column, float(values.min()), float(values.max()), effective, _resolution(recorded))


def _resolution(values: Array) -> float | None:
    with np.errstate(over="ignore"):  # of numbers at the end of what there is
        steps = np.abs(np.diff(values))
    steps = steps[(steps > 0.0) & (steps < np.inf)]
    return float(steps.min()) if steps.size else None


def _columns(recording: Recording, chosen: Mapping[str, SignalColumn], how: ReadingOptions) -> Iterator[ColumnSummary]:
    """Every column of the axis in numbers, with what it is read as or likely to be."""
    channels = of_axis(recording, how.axis)
    read = {choice.channel: signal for signal, choice in chosen.items()}
    likely, suggested = candidates(channels), {*how.columns}
    lines: dict[Channel, str] = {}
    for channel in sorted(likely, key=lambda channel: channel not in read):
        one = likely[channel]
        key = one.signal if channel.axis is None else f"{channel.axis}.{one.signal}"
        if key in suggested or (channel not in read and one.signal in chosen):
            continue
        suggested.add(key)
        if channel not in read or not one.known or one.usual is not None:
            unit = one.unit or one.usual or ("" if channel.moments or channel in read else "?")
            unit = "?" if unit and scale_or_none(unit, wanted_units(one.signal)) is None else unit
            text = recording.column(channel) + (f" [{unit}]" if unit else "")
            lines[channel] = f"{one.signal} = {json.dumps(text, ensure_ascii=False)}"
    for channel in channels:
        numbers = channel.values[np.isfinite(channel.values)]
        one = likely.get(channel)
        yield ColumnSummary(
            name=channel.name,
            unit=channel.unit,
            axis=channel.axis,
            count=int(numbers.size),
            minimum=float(numbers.min()) if numbers.size else None,
            maximum=float(numbers.max()) if numbers.size else None,
            resolution=_resolution(numbers),
            rate=_rate(channel),
            signal=read.get(channel, one.signal if one is not None else None),
            read=channel in read,
            why=(str(channel.defect.found),) if channel.defect is not None else one.why if one is not None else (),
            suggestion=lines.get(channel),
        )


def _rate(channel: Channel) -> float | None:
    if channel.time is None or channel.time.values.size < 2:
        return None
    step = float(np.median(np.diff(channel.time.values)))
    seconds = step * scale_in("time", channel.time.unit or "s", channel.time.place()).factor
    return 1.0 / seconds if seconds > 0.0 else None
