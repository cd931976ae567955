"""An inspection for a person: tables, and every signal over time on one page."""

from __future__ import annotations

from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from bench.names import plain
from bench.trace.inspect import ColumnSummary, Inspection

_MOST_HOLES = 5


def table(inspection: Inspection) -> Group:
    """The inspection for a person."""
    facts = Table(box=None, show_header=False, pad_edge=False)
    for name, value in _facts(inspection):
        facts.add_row(name, Text(plain(value)))
    parts: list[Table | Text] = [facts]
    if inspection.signals:
        parts.append(_signals(inspection))
    rest = [column for column in inspection.columns if not column.read]
    if rest:
        parts.append(_columns(rest))
    parts += [Text(plain(f"note: {note}")) for note in inspection.notes]
    if inspection.asks is not None:
        parts.append(Text(plain(f"not read as a trace yet: {inspection.asks}")))
    if inspection.suggestions and inspection.asks is not None:
        parts.append(Text(plain("\n".join(["likely, for the rig:", "[trace.columns]", *inspection.suggestions]))))
    return Group(*parts)


def _signals(inspection: Inspection) -> Table:
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
    return signals


def _columns(columns: list[ColumnSummary]) -> Table:
    """Columns that are not read as a signal."""
    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("column", "unit"):
        table.add_column(heading)
    for heading in ("min", "max", "resolution"):
        table.add_column(heading, justify="right")
    table.add_column("likely")
    for column in columns:
        numbers = (column.minimum, column.maximum, column.resolution)
        texts = ("" if number is None else f"{number:.5g}" for number in numbers)
        likely = f"{column.signal}: {', '.join(column.why)}" if column.signal else ", ".join(column.why)
        name = column.name if column.axis is None else f"{column.name} ({column.axis})"
        table.add_row(Text(plain(name)), Text(plain(column.unit or "")), *texts, Text(plain(likely)))
    return table


def _facts(inspection: Inspection) -> list[tuple[str, str]]:
    facts = [("file", inspection.origin), ("format", inspection.format)]
    if len(inspection.axes) > 1:
        facts.append(("axes", ", ".join(inspection.axes)))
    if inspection.samples is None or inspection.start is None or inspection.duration is None:
        return facts
    segments = inspection.segments
    facts += [
        ("samples", f"{inspection.samples} in {segments} segment{'s' * (segments != 1)}"),
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
