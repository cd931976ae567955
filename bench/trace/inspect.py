"""What a recording holds, told before anyone identifies from it: rate, jitter, holes, and each signal's range."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from bench.arrays import Array, rms
from bench.names import plain
from bench.structured import json_text
from bench.trace.assemble import assemble, choose, in_si
from bench.trace.read import read_recording

SCHEMA = "bench.inspect/1"
_MOST_HOLES = 5


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
class Inspection:
    """What a recording holds.

    Attributes:
        origin, format: the file and what it is.
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
    samples: int
    segments: int
    start: float
    duration: float
    rate: float
    jitter: float
    holes: tuple[tuple[float, float], ...]
    duplicates: int
    interpolated: int
    resampled: bool
    signals: tuple[SignalSummary, ...]
    dropped: tuple[str, ...]
    metadata: Mapping[str, str]
    notes: tuple[str, ...]


def inspect(path: str | Path, columns: Mapping[str, str] | None = None) -> Inspection:
    """Look into a recording.

    Raises:
        InputError: as `bench.trace.read.read` does.
    """
    recording = read_recording(path)
    chosen, _ = choose(recording, columns or {})
    trace = assemble(recording, columns)
    recorded, _ = in_si(chosen, recording)
    base = trace.time_base
    assert base is not None  # a trace that was read has one
    used = {id(choice.channel) for choice in chosen.values()}
    signals = tuple(
        _summary(name, trace.units[name], chosen[name].channel.label, values, recorded[name].values)
        for name, values in trace.signals.items()
    )
    return Inspection(
        origin=trace.origin,
        format=recording.format,
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
        dropped=tuple(channel.label for channel in recording.channels if id(channel) not in used),
        metadata=dict(recording.metadata),
        notes=trace.notes,
    )


def _summary(name: str, unit: str, column: str, values: Array, recorded: Array) -> SignalSummary:
    steps = np.abs(np.diff(recorded))
    steps = steps[steps > 0.0]
    largest = float(np.abs(values).max())
    effective = largest * rms(values / largest) if largest > 0.0 else 0.0
    resolution = float(steps.min()) if steps.size else None
    return SignalSummary(name, unit, column, float(values.min()), float(values.max()), effective, resolution)


def to_json(inspection: Inspection, more: Mapping[str, object] = MappingProxyType({})) -> str:
    """The inspection as JSON, its fields under their names, and what others have to say of the recording."""
    return json_text({"schema": SCHEMA, **asdict(inspection), **more})


def table(inspection: Inspection) -> Group:
    """The inspection for a person."""
    facts = Table(box=None, show_header=False, pad_edge=False)
    for name, value in _facts(inspection):
        facts.add_row(name, Text(plain(value)))
    signals = Table(box=box.SIMPLE_HEAD)
    signals.add_column("signal")
    signals.add_column("column")
    signals.add_column("unit")
    for heading in ("min", "max", "rms", "resolution"):
        signals.add_column(heading, justify="right")
    for signal in inspection.signals:
        numbers = (signal.minimum, signal.maximum, signal.rms, signal.resolution)
        texts = ("constant" if number is None else f"{number:.5g}" for number in numbers)
        signals.add_row(signal.name, Text(plain(signal.column)), signal.unit, *texts)
    return Group(facts, signals, *(Text(plain(f"note: {note}")) for note in inspection.notes))


def _facts(inspection: Inspection) -> list[tuple[str, str]]:
    facts = [
        ("file", inspection.origin),
        ("format", inspection.format),
        ("samples", f"{inspection.samples} in {inspection.segments} segment{'s' * (inspection.segments != 1)}"),
        ("time", f"{inspection.start:g} s to {inspection.start + inspection.duration:g} s"),
        ("rate", f"{inspection.rate:.6g} Hz"),
        ("jitter", f"{inspection.jitter:.2%} of a sample period" + (", resampled" * inspection.resampled)),
        ("interpolated", str(inspection.interpolated)),
        ("duplicates", str(inspection.duplicates)),
    ]
    holes = [f"{duration:.3g} s at {start:g} s" for start, duration in inspection.holes]
    more = len(holes) - _MOST_HOLES
    facts.append(("holes", ", ".join(holes[:_MOST_HOLES]) + (f" and {more} more" if more > 0 else "") or "none"))
    if inspection.dropped:
        facts.append(("columns not used", ", ".join(inspection.dropped)))
    return facts
