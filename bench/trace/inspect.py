"""What a recording holds, before it is used: every column and, where they are clear, the signals."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from bench.arrays import Array, rms
from bench.errors import InputError
from bench.structured import json_text
from bench.trace.channel import Channel, Recording
from bench.trace.choose import ReadingOptions, SignalColumn, axes_of, choose, of_axis, reading_options
from bench.trace.in_si import InSI, in_si
from bench.trace.likely import Guess, likely_signals
from bench.trace.read import read_recording
from bench.trace.signals import scale_in
from bench.trace.trace import Trace, on_time_base, unused

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
        axis: of a file that tells several apart.
        count: of its numbers.
        minimum, maximum, resolution: of its numbers, in the file's unit; None where it holds none, or never changes.
        rate: of its samples, where it has times of its own - Hz.
        signal: that it is read as, or probably is; None if unknown.
        read: whether it is read as that.
        why: the reasons.
        suggestion: line for the rig's `[trace.columns]`, if it is not read.
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
    """What a recording holds; only columns and `asks` if its signals are not clear.

    Attributes:
        origin, format: the file and what it is.
        columns: of the file, in its order.
        axes: of the file.
        asks: why the file cannot be read as it is, and what to write; None if it can.
        samples: on the regular time base.
        segments: stretches between holes.
        start, duration: of the recording - s.
        rate: sample rate - Hz.
        jitter: largest deviation of a step from whole sample periods - share of the period.
        holes: (start, duration) of each - s.
        duplicates: samples dropped because their time stood already in the recording.
        interpolated: samples placed between measured ones.
        resampled: whether jittering samples were interpolated onto regular times.
        signals: in the order of `bench.trace.signals`.
        dropped: columns that are no known signal.
        metadata: what the file says about itself.
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
    signals: tuple[SignalSummary, ...] = ()
    dropped: tuple[str, ...] = ()
    metadata: Mapping[str, str] | None = None
    notes: tuple[str, ...] = ()

    @property
    def suggestions(self) -> tuple[str, ...]:
        """Lines for the rig's `[trace.columns]`."""
        return tuple(column.suggestion for column in self.columns if column.suggestion is not None)


def inspect(path: str | Path, columns: Mapping[str, str] | ReadingOptions | None = None) -> Inspection:
    """Look into a recording.

    Args:
        path: file of any format.
        columns: as for `bench.trace.read.read`.

    Raises:
        InputError: no table or container that the bench knows; a column that the rig names is not there, or has no
            unit. A file that needs a rig to be read is no error here.
    """
    return inspect_recording(read_recording(path), reading_options(columns))


def inspect_recording(recording: Recording, how: ReadingOptions) -> Inspection:
    """See `inspect`."""
    try:
        chosen, notes = choose(recording, how)
        found = in_si(chosen, recording, how)
        trace = on_time_base(found, recording, chosen, (*recording.notes, *notes))
    except InputError as error:
        if how.columns:
            raise
        summaries = _columns(recording, {}, how)
        return Inspection(
            recording.origin,
            recording.format,
            summaries,
            axes_of(recording.channels),
            str(error),
            metadata=dict(recording.metadata),
            notes=recording.notes,
        )
    return _of_trace(recording, chosen, found, trace, how)


def _of_trace(
    recording: Recording, chosen: Mapping[str, SignalColumn], found: InSI, trace: Trace, how: ReadingOptions
) -> Inspection:
    base = trace.time_base
    assert base is not None  # a trace that was read has one
    signals = tuple(
        _summary(name, trace.units[name], chosen[name].channel.label, values, found.signals[name].values)
        for name, values in trace.signals.items()
    )
    return Inspection(
        origin=trace.origin,
        format=recording.format,
        columns=_columns(recording, chosen, how),
        axes=axes_of(recording.channels),
        asks=None,
        samples=len(trace),
        segments=len(trace.segments),
        start=float(trace.time[0]),
        duration=float(trace.time[-1] - trace.time[0]),
        rate=1.0 / base.sample_period,
        jitter=base.jitter,
        holes=base.holes,
        duplicates=base.duplicates,
        interpolated=base.interpolated,
        resampled=base.resampled,
        signals=signals,
        dropped=tuple(unused(chosen, recording)),
        metadata=dict(recording.metadata),
        notes=trace.notes,
    )


def _summary(name: str, unit: str, column: str, values: Array, recorded: Array) -> SignalSummary:
    largest = float(np.abs(values).max())
    effective = largest * rms(values / largest) if largest > 0.0 else 0.0
    return SignalSummary(name, unit, column, float(values.min()), float(values.max()), effective, _resolution(recorded))


def _resolution(values: Array) -> float | None:
    with np.errstate(over="ignore"):  # of numbers at the end of what there is
        steps = np.abs(np.diff(values))
    steps = steps[(steps > 0.0) & (steps < np.inf)]
    return float(steps.min()) if steps.size else None


def _columns(
    recording: Recording, chosen: Mapping[str, SignalColumn], how: ReadingOptions
) -> tuple[ColumnSummary, ...]:
    """Every column of the axis in numbers, with what it is read as or likely to be."""
    channels = of_axis(recording, how.axis)
    read = {id(choice.channel): signal for signal, choice in chosen.items()}
    guesses = likely_signals(channels)
    return tuple(
        _column(channel, read.get(id(channel)), guesses.get(place), set(chosen))
        for place, channel in enumerate(channels)
    )


def _column(channel: Channel, read: str | None, guess: Guess | None, known: set[str]) -> ColumnSummary:
    numbers = channel.values[np.isfinite(channel.values)]
    signal, why, suggestion = read, (), None
    if read is None and guess is not None and guess.signal not in known:
        signal, why, suggestion = guess.signal, guess.why, suggested(channel, guess)
    return ColumnSummary(
        name=channel.name,
        unit=channel.unit,
        axis=channel.axis,
        count=int(numbers.size),
        minimum=float(numbers.min()) if numbers.size else None,
        maximum=float(numbers.max()) if numbers.size else None,
        resolution=_resolution(numbers),
        rate=_rate(channel),
        signal=signal,
        read=read is not None,
        why=why if channel.defect is None else (str(channel.defect.found),),
        suggestion=suggestion,
    )


def suggested(channel: Channel, guess: Guess) -> str:
    """Line for `[trace.columns]`; `?` stands where only the user knows the unit."""
    unit = "" if channel.moments else f" [{guess.unit or '?'}]"
    return f"{guess.signal} = {json.dumps(channel.name + unit, ensure_ascii=False)}"


def _rate(channel: Channel) -> float | None:
    if channel.time is None or channel.time.values.size < 2:
        return None
    step = float(np.median(np.diff(channel.time.values)))
    seconds = step * scale_in("time", channel.time.unit or "s", channel.time.place()).factor
    return 1.0 / seconds if seconds > 0.0 else None


def to_json(inspection: Inspection, more: Mapping[str, object] = MappingProxyType({})) -> str:
    """The inspection as JSON, its fields under their names, and what others have to say of the recording."""
    return json_text({"schema": SCHEMA, **asdict(inspection), "suggestions": inspection.suggestions, **more})
