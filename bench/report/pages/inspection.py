"""The page of an inspection: what a recording holds, every signal over time, and what its checks say."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Literal

from bench.gate.check import Check
from bench.names import words
from bench.report.document import (
    AnyPart,
    Document,
    Heading,
    Paragraph,
    Points,
    Section,
    Table,
    TimeCurve,
    TimeGraph,
    TimePanel,
    Tone,
)
from bench.report.numbers import number, unit_text
from bench.report.over_time import Grid
from bench.report.parts import checks_section, origin
from bench.trace.inspect import ColumnSummary, Inspection
from bench.trace.trace import Trace

#: How the signals of one unit are told apart, in their order.
ROLES: tuple[Literal["measured", "model", "left"], ...] = ("measured", "model", "left")
#: Holes that are listed one by one.
MOST_HOLES = 20


def inspection_page(found: Inspection, checks: Sequence[Check], trace: Trace | None) -> Document:
    """The page of an inspection.

    Args:
        found: in the recording.
        checks: what the gate found; () of a recording that is not read.
        trace: the recording as it is read; None where `found.asks` something first.
    """
    name, verdict = Path(found.origin).name, _verdict(found, checks)
    sections = []
    if trace is not None:
        sections.append(Section(key="signals", heading="Signals", blocks=(signals_graph(trace), _signals(found))))
    if found.asks is not None:
        sections.append(Section(key="asked", heading="What to write", blocks=_what_to_write(found)))
    rest = [column for column in found.columns if not column.read]
    if rest:
        sections.append(Section(key="columns", heading="Columns that are not read", blocks=(_columns(rest),)))
    if checks or found.notes:
        sections.append(checks_section(checks, found.notes))
    return Document(
        title=name,
        subject=f"Inspection of {name} ({found.format})",
        verdict=verdict[0],
        tone=verdict[1],
        answers=_answers(found),
        sections=tuple(sections),
        origin=origin(None),
    )


def signals_graph(trace: Trace) -> TimeGraph:
    """Every signal of a recording over time; those of one unit share a panel."""
    signals = sorted(trace.signals, key=lambda name: list(trace.units.values()).index(trace.units[name]))
    grid = Grid.of(trace.time, len(signals))
    places, panels = grid.places(trace.time), []
    for unit, named in groupby(signals, key=lambda name: trace.units[name]):
        names = list(named)
        curves = tuple(
            TimeCurve(
                name=words(name),
                role=ROLES[k % len(ROLES)],
                choice=None,
                samples=grid.samples(places, trace.signals[name]),
            )
            for k, name in enumerate(names)
        )
        panels.append(TimePanel(label=words(names[0]), unit=unit_text(unit), curves=curves))
    alternative = f"{', '.join(map(words, signals))} of the recording."
    return TimeGraph(
        title="Over time.",
        alternative=alternative,
        start=grid.start,
        step=grid.step,
        count=grid.count,
        panels=tuple(panels),
    )


def _verdict(found: Inspection, checks: Sequence[Check]) -> tuple[str, Tone]:
    """What the recording is good for, in a sentence, and how that is meant."""
    if found.asks is not None or found.duration is None or found.rate is None:
        return "It is not read as a recording yet: its signals have to be told first.", "refused"
    names = [words(signal.name) for signal in found.signals]
    held = f"It holds {number(found.duration, 's', 4)} of {', '.join(names)} at {number(found.rate, 'Hz', 6)}"
    failed = [words(check.name) for check in checks if check.status == "fail"]
    warned = [words(check.name) for check in checks if check.status == "warn"]
    if failed:
        return f"{held}, but cannot be identified from: {', '.join(failed)}.", "refused"
    if warned:
        return f"{held}; with care: {', '.join(warned)}.", "open"
    return f"{held}, and every check passed.", "sure"


def _answers(found: Inspection) -> dict[str, str]:
    answers = {"What is it?": f"{found.format}, {len(found.columns)} columns"}
    if len(found.axes) > 1:
        answers["Which axes?"] = ", ".join(found.axes)
    if found.samples is not None and found.start is not None and found.duration is not None:
        times = f"{number(found.start)} to {number(found.start + found.duration, 's')}"
        answers["How long?"] = f"{found.samples} samples, {times}"
        answers["Is anything lost?"] = _lost(found)
    return answers


def _lost(found: Inspection) -> str:
    holes = [f"{number(duration, 's', 3)} at {number(start, 's')}" for start, duration in found.holes[:MOST_HOLES]]
    more = len(found.holes) - len(holes)
    parts = [f"holes of {', '.join(holes)}" + (f" and {more} more" if more > 0 else "")] if holes else ["no hole"]
    parts += [f"{found.interpolated} samples interpolated"] if found.interpolated else []
    parts += [f"{found.duplicates} samples stood there twice"] if found.duplicates else []
    return "; ".join(parts)


def _signals(found: Inspection) -> Table:
    columns = tuple(Heading(heading=heading) for heading in ("signal", "column", "unit"))
    columns += tuple(Heading(heading=heading, number=True) for heading in ("least", "most", "RMS", "resolution"))
    rows = tuple(
        (
            words(signal.name),
            signal.column,
            unit_text(signal.unit),
            *(number(value, digits=5) for value in (signal.minimum, signal.maximum, signal.rms)),
            "constant" if signal.resolution is None else number(signal.resolution, digits=3),
        )
        for signal in found.signals
    )
    return Table(caption="What is read, in SI units", columns=columns, rows=rows)


def _columns(columns: Sequence[ColumnSummary]) -> Table:
    headings = (Heading(heading="column"), Heading(heading="unit"))
    headings += tuple(Heading(heading=heading, number=True) for heading in ("least", "most", "resolution"))
    rows = tuple(
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
    return Table(caption="In the file's units", columns=(*headings, Heading(heading="likely", prose=True)), rows=rows)


def _what_to_write(found: Inspection) -> tuple[AnyPart, ...]:
    """What keeps the file from being read, and the lines of a rig that would help."""
    lines = (Points(items=("[trace.columns]", *found.suggestions)),) if found.suggestions else ()
    heading = (Paragraph(text="Likely, for the rig file:"),) if lines else ()
    return (Paragraph(text=f"{found.asks}."), *heading, *lines)
