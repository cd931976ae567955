"""Reader of TwinCAT Scope CSV: a header table keyed by its first cell, then columns of times and values.

The row of names determines the layout: each cell `Name` is over a time column, and the cells up to the next one over
the channels sampled by it. Times are ms from the start, or Windows FILETIME. Separator (tab, semicolon, comma) and
decimal mark depend on the export's settings. Channels end at different rows, and cells may be empty where a channel is
sampled more slowly; `EOF` may close the file. An option of the export scales values before it, and the file does not
state whether that was done: where the header names a scaling, the unit is open (Beckhoff TE13xx, Export in csv).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pyarrow as pa

from bench.arrays import Array
from bench.errors import InputError
from bench.trace.channel import Channel, Recording, with_shared_times
from bench.trace.readers.table import TableLayout, channel_of_cells, parsed
from bench.trace.source import FileFormat, Source, decode, no_samples, shows

_HEAD = re.compile(r"\AName[\t;,].*^(Starttime of export|Data-Type|SymbolName)[\t;,]", re.DOTALL | re.MULTILINE)
_NUMBER = re.compile(r"\s*[+-]?\d")
_TICKS = re.compile(r"[0-9]{1,19}")
_FILETIME = re.compile(rb"\s*\d{17,19}\D")
_LAST_MOMENT = 2.6e17  # us; a date of Python ends with the year 9999
_NO_SCALING = {"Offset": "0", "ScaleFactor": "1", "Unit Offset": "0", "Unit ScaleFactor": "1"}


def _read(source: Source) -> Recording:
    separator = source.head[len("Name")]
    header, rows, line = _split(source, separator)
    names = _names(header, source)
    text = b"\n".join(_filled(rows, separator.encode(), len(names)))
    instants = _FILETIME.match(rows[0] + b"\n") is not None  # in steps of 100 ns, from the first of all
    kinds = tuple("exact" if instants and name == "Name" else "number" for name in names)
    decimal = "," if separator != "," and re.search(rb"\d,\d", text) else "."
    table, first, _ = parsed(text, line, TableLayout(tuple(names), separator, decimal, 0, kinds), source.path)
    start = min((_first(column) for column in table.columns if pa.types.is_decimal(column.type)), default=0)
    time = np.empty(0)
    channels: list[Channel] = []
    for number, (name, column) in enumerate(zip(names, table.columns, strict=True)):
        cells = channel_of_cells(name, column, decimal, source.path, first)
        if cells.defect is not None:
            raise cells.defect
        if name == "Name":
            exact = pa.types.is_decimal(column.type)
            time = (cells.values + (_first(column) - start)) / 1e4 if exact else cells.values
        elif number > 0:
            head = {row[0]: row[number] for row in header if len(row) > number}
            channels.append(_channel(name, head, time, cells))
    return Recording(with_shared_times(channels), TWINCAT.format, source.path, _metadata(header))


TWINCAT = FileFormat("TwinCAT Scope CSV", (), shows(_HEAD), _read)


def _split(source: Source, separator: str) -> tuple[list[list[str]], list[bytes], int]:
    """Cells of the header's rows, rows of samples, and the number of their first line."""
    header: list[list[str]] = []
    rows = source.content.split(b"\n")
    for number, row in enumerate(rows):
        cells = [cell.strip() for cell in decode(row).split(separator)]
        # the first time column may have ended or not begun: its cells are empty, yet the row has numbers
        if any(_NUMBER.match(cell) for cell in cells) and (not cells[0] or _NUMBER.match(cells[0])):
            return header, rows[number:], number + 1
        if any(cells):
            header.append(cells)
    raise no_samples(source)


def _names(header: list[list[str]], source: Source) -> list[str]:
    """Cells of the row of channel names: the last one that begins with `Name`, as the first names the project."""
    rows = [cells for cells in header if cells[0] == "Name"]
    if len(rows) < 2:
        allowed = "allowed: a TwinCAT Scope export with its header"
        raise InputError(source.path, "found no row of channel names", allowed)
    last = max(number for number, cell in enumerate(rows[-1]) if cell)
    return rows[-1][: last + 1]


def _filled(rows: list[bytes], mark: bytes, width: int) -> Iterator[bytes]:
    """Rows of samples, which end with the last channel that still has some, filled up."""
    for row in rows:
        if row.strip() not in (b"", b"EOF"):
            yield row.rstrip(b"\r") + mark * (width - 1 - row.count(mark))


def _first(column: pa.ChunkedArray) -> int:
    """The first number of a column; 0 where it has none."""
    return int(next(iter(column.drop_null()[:1].to_pylist()), 0))


def _channel(name: str, head: Mapping[str, str], time: Array, cells: Channel) -> Channel:
    """The channel of a column with its head's entries: samples where both time and value stand; one alone is a defect.

    Its unit is open where the head names a scaling.
    """
    unit = head.get("Unit", "(None)")
    scaling = [f"{key} {head[key]}" for key, plain in _NO_SCALING.items() if head.get(key, plain) not in (plain, "")]
    reason = None
    if scaling:
        reason = f"has an open unit: the header names '{unit}' and {', '.join(scaling)}, not whether values are scaled"
        unit = None
    every = Channel(name, unit, cells.values, cells.origin, line=cells.line, open_unit=reason)
    present = ~np.isnan(time)
    rows = np.flatnonzero(present)
    gapless = rows.size > 0 and rows[-1] - rows[0] == rows.size - 1
    line = (every.line or 0) + int(rows[0]) if gapless else None
    lonely = present != ~np.isnan(every.values)
    defect = None
    if lonely.any():
        place = every.place(int(np.argmax(lonely)))
        defect = InputError(
            place, "found a time without a value, or a value without a time", "allowed: both; the file may be truncated"
        )
    clock = Channel("time", "ms", time[present], every.origin, line=line)
    return replace(every, values=every.values[present], line=line, time=clock, defect=defect)


def _metadata(header: list[list[str]]) -> dict[str, str]:
    metadata = {"project": header[0][1]} if len(header[0]) > 1 else {}
    for cells in header:
        if cells[0].endswith("time of export") and len(cells) > 1 and _TICKS.fullmatch(cells[1]):
            microseconds = int(cells[1]) // 10  # Windows FILETIME: steps of 100 ns since 1601
            if microseconds < _LAST_MOMENT:
                moment = datetime(1601, 1, 1, tzinfo=UTC) + timedelta(microseconds=microseconds)
                metadata[cells[0].lower()] = moment.isoformat()
    return metadata
