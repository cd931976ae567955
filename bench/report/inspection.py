"""An inspection: the contents of a recording, every signal over time, and its checks."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Literal

import numpy as np

from bench.errors import InputError
from bench.gate.check import Check
from bench.names import counted, readable, words
from bench.report import document as doc
from bench.report.numbers import number, sentence, share, unit_text
from bench.report.over_time import Grid
from bench.report.parts import checks_section, origin
from bench.trace.channel import Channel, Recording
from bench.trace.choose import ReadingOptions, of_axis
from bench.trace.inspect import ColumnSummary, Inspection
from bench.trace.trace import Trace, assemble

#: How the signals of one unit are distinguished, in their order.
ROLES: tuple[Literal["measured", "model", "residual"], ...] = ("measured", "model", "residual")
#: Holes that are listed one by one.
MOST_HOLES = 20
#: Columns of a picture that can still be read.
MOST = 16


def inspection(
    found: Inspection, checks: Sequence[Check] = (), trace: Trace | None = None, command: str = "bench identify"
) -> doc.Document:
    """The document of an inspection.

    Args:
        checks: what the gate found; () of a recording that is not read.
        trace: the recording as it is read; None where `found.asks` is set.
        command: that identifies what was recorded.
    """
    name, (verdict, tone) = readable(Path(found.origin).name), _verdict(found, checks)
    rest = [column for column in found.columns if not column.read]
    graph = [] if trace is None else [signals_graph(trace)]
    signals = [*graph, _signals(found)] if found.signals else []
    return doc.Document(
        title=name,
        subject=f"Inspection of {name} ({found.format})",
        verdict=verdict,
        tone=tone,
        answers={**dict(_answers(found)), "What next?": _next(found, checks, command)},
        sections=doc.sections(
            doc.section("signals", "Signals", *signals),
            doc.section("asked", "What to write", *_what_to_write(found)),
            doc.section("columns", "Columns that are not read", *([_columns(rest)] if rest else [])),
            checks_section(checks, found.notes, detail=False),
        ),
        origin=origin(None),
    )


def signals_graph(trace: Trace) -> doc.TimeGraph:
    """Every signal of a recording over time; those of one unit share a panel."""
    signals = sorted(trace.signals, key=lambda name: list(trace.units.values()).index(trace.units[name]))
    grid = Grid.of(trace.time, len(signals))
    places, panels = grid.places(trace.time), []
    for unit, named in groupby(signals, key=lambda name: trace.units[name]):
        names = list(named)
        curves = tuple(
            doc.TimeCurve(name=words(name), role=role, choice=None, samples=grid.samples(places, trace.signals[name]))
            for name, role in zip(names, ROLES * len(names), strict=False)
        )
        panels.append(doc.TimePanel(label=words(names[0]), unit=unit_text(unit), curves=curves))
    return doc.TimeGraph(
        title="Over time.",
        alternative=f"{', '.join(map(words, signals))} of the recording.",
        start=grid.start,
        step=grid.step,
        count=grid.count,
        panels=tuple(panels),
    )


def signals_picture(recording: Recording, how: ReadingOptions) -> doc.Picture:
    """The signals over time, holes as gaps; of a recording that needs a rig, the columns that change over samples."""
    title = readable(Path(recording.origin).name)
    try:
        drawn = signals_graph(assemble(recording, how))
    except InputError:
        channels = [channel for channel in of_axis(recording, how.axis) if _changes(channel)]
        panels = []
        for channel in channels[:MOST]:
            line = doc.series("", "line", "ink", np.arange(channel.values.size, dtype=np.float64), channel.values)
            panels.append(doc.Panel(x_label="sample", y_label=channel.label, series=(line,)))
        if not panels:
            panels.append(doc.Panel(x_label="sample", y_label="no column changes", series=()))
        more = len(channels) - MOST
        title += f" and {more} columns more" if more > 0 else ""
        drawn = doc.Chart(title="", alternative="Columns over samples.", panels=tuple(panels))
    return doc.Picture(name="signals", title=title, rows=((drawn,),))


def _changes(channel: Channel) -> bool:
    numbers = channel.values[np.isfinite(channel.values)]
    return channel.defect is None and numbers.size > 1 and bool(np.ptp(numbers))


def _verdict(found: Inspection, checks: Sequence[Check]) -> tuple[str, doc.Tone]:
    """What the recording is good for, in a sentence, and how that is meant."""
    if found.asks is not None or found.duration is None or found.rate is None:
        several = f"It has {len(found.axes)} axes: pick one with --axis {found.axes[0]}." if _of_axes(found) else ""
        return several or "It cannot be read yet: the rig has to state what its columns are.", "refused"
    names = ", ".join(words(signal.name) for signal in found.signals)
    held = f"It contains {number(found.duration, 's', 4)} of {names} at {number(found.rate, 'Hz', 6)}"
    failed, warned = (
        ", ".join(words(check.name) for check in checks if check.status == status) for status in ("fail", "warn")
    )
    if failed:
        return f"{held}, but cannot be identified from: {failed}.", "refused"
    if warned:
        return f"{held}; with care: {warned}.", "open"
    return f"{held}, and every check passed.", "sure"


def _answers(found: Inspection) -> Iterator[tuple[str, str]]:
    yield "What is it?", f"{readable(found.origin)}: {found.format}, {counted(len(found.columns), 'column')}"
    if len(found.axes) > 1:
        yield "Which axes?", ", ".join(found.axes)
    if found.samples is not None and found.start is not None and found.duration is not None:
        parts = f"{found.segments} segment{'s' * (found.segments != 1)}"
        times = f"{number(found.start)} to {number(found.start + found.duration, 's')}"
        yield "How long?", f"{found.samples} samples in {parts}, {times}"
        yield "How regular?", f"jitter {share(found.jitter or 0.0)} of a sample period{', resampled' * found.resampled}"
        yield "Is anything lost?", _lost(found)
    if found.dropped:
        yield "What is not used?", ", ".join(found.dropped)


def _next(found: Inspection, checks: Sequence[Check], command: str) -> str:
    """What lets the recording be read, what to repair in it, or the command that identifies it."""
    if found.asks is not None:
        return f"`{_of_first(found)}`" if _of_axes(found) else f"{sentence(found.asks)}."
    if failed := [check for check in checks if check.status == "fail"]:
        return f"{sentence(failed[0].advice or failed[0].found)}."
    return f"`{command}` determines inertia and friction."


def _of_first(found: Inspection) -> str:
    """The command that inspects the first axis."""
    return shlex.join(["bench", "inspect", readable(found.origin), "--axis", found.axes[0]])


def _lost(found: Inspection) -> str:
    holes = [f"{number(duration, 's', 3)} at {number(start, 's')}" for start, duration in found.holes[:MOST_HOLES]]
    more = len(found.holes) - len(holes)
    parts = [f"holes of {', '.join(holes)}" + (f" and {more} more" if more > 0 else "")] if holes else ["no hole"]
    parts += [f"{found.interpolated} samples interpolated"] if found.interpolated else []
    parts += [f"{found.duplicates} duplicate samples"] if found.duplicates else []
    return "; ".join(parts)


def _signals(found: Inspection) -> doc.Table:
    rows = (
        (
            words(signal.name),
            signal.column,
            unit_text(signal.unit),
            *(number(value, digits=5) for value in (signal.minimum, signal.maximum, signal.rms)),
            "constant" if signal.resolution is None else number(signal.resolution, digits=3),
        )
        for signal in found.signals
    )
    headings = ("signal", "column", "unit", "least>", "most>", "RMS>", "resolution>")
    return doc.table("What is read, in SI units", headings, rows)


def _columns(columns: Sequence[ColumnSummary]) -> doc.Table:
    rows = (
        (
            column.name if column.axis is None else f"{column.name} ({column.axis})",
            column.unit or "",
            *(
                "" if value is None else number(value, digits=5)
                for value in (column.minimum, column.maximum, column.resolution)
            ),
            f"{words(column.signal)}: {', '.join(column.why)}" if column.signal else ", ".join(column.why),
        )
        for column in columns
    )
    return doc.table("In the file's units", ("column", "unit", "least>", "most>", "resolution>", "likely~"), rows)


def _of_axes(found: Inspection) -> bool:
    """Whether the only open question is which of several axes to read."""
    return len(found.axes) > 1 and "--axis" in (found.asks or "")


def _what_to_write(found: Inspection) -> Iterator[doc.AnyPart]:
    """What keeps the file from being read, if anything, and the command or the lines of a rig that help."""
    if found.asks is not None:
        yield doc.Paragraph(text=f"{found.asks}.")
        if _of_axes(found):
            yield doc.Code(text=_of_first(found))
        elif found.suggestions:
            yield doc.Paragraph(text="Likely, for the rig file:")
            yield doc.Code(text="\n".join(("[trace.columns]", *found.suggestions)))
