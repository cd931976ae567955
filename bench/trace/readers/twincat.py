"""Reader of TwinCAT Scope CSV: a header table keyed by its first cell, one column per channel, times in ms.

The row of names tells the layout: each cell `Name` stands over a time column, and the cells up to the next one over the
channels sampled by it. Separator (tab, semicolon, comma) and decimal mark depend on the export's settings. Channels
end at different rows; `EOF` may close the file. Values are already scaled to the unit the header names.
"""

from __future__ import annotations

import re
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pyarrow as pa

from bench.errors import InputError
from bench.trace.channel import Channel, Recording, with_shared_times
from bench.trace.readers.columns import parse_columns
from bench.trace.source import Source, decode

FORMAT = "TwinCAT Scope CSV"
ENDINGS = ()

_HEAD = re.compile(r"\AName[\t;,].*^(Starttime of export|Data-Type|SymbolName)[\t;,]", re.DOTALL | re.MULTILINE)
_NUMBER = re.compile(r"\s*[+-]?\d")
_EMPTY = ("", " ")


def recognises(source: Source) -> bool:
    """Whether the head is that of an export."""
    return _HEAD.match(source.head) is not None


def read(source: Source) -> Recording:
    """Recording of an export.

    Raises:
        InputError: no channels, no samples, a line with too many cells, text in a number.
    """
    separator = source.head[len("Name")]
    header, body, line = _split(source, separator)
    names = _names(header, source)
    units = next((cells for cells in header if cells[0] == "Unit"), [])
    units += ["(None)"] * (len(names) - len(units))
    table = _table(body, len(names), separator, line, source)
    time: Channel | None = None
    channels: list[Channel] = []
    for number, name in enumerate(names):
        channel = Channel(name, units[number], np.empty(0), source.path, line=line)
        channel = _filled(channel, table.column(number))
        if name == "Name":
            time = replace(channel, name="time", unit="ms")
        elif time is not None:
            channels.append(_with_time(channel, time))
    return Recording(with_shared_times(channels), FORMAT, source.path, _metadata(header))


def _split(source: Source, separator: str) -> tuple[list[list[str]], bytes, int]:
    """Header rows, bytes of the samples, and the number of their first line."""
    start, line, header = 0, 1, []
    while start < len(source.content):
        end = source.content.find(b"\n", start)
        end = len(source.content) if end < 0 else end
        cells = [cell.strip() for cell in decode(source.content[start:end], source.path).split(separator)]
        # the first time column may have ended or not begun: its cells are empty, yet the row holds numbers
        if any(_NUMBER.match(cell) for cell in cells) and (not cells[0] or _NUMBER.match(cells[0])):
            return header, source.content[start:], line
        if any(cells):
            header.append(cells)
        start, line = end + 1, line + 1
    raise InputError(source.path, "found a header and no samples", "allowed: at least two samples")


def _names(header: list[list[str]], source: Source) -> list[str]:
    """Cells of the row of channel names: the last one that begins with `Name`, as the first names the project."""
    rows = [cells for cells in header if cells[0] == "Name"]
    if len(rows) < 2:
        raise InputError(
            source.path, "found no row of channel names", "allowed: a TwinCAT Scope export with its header"
        )
    names = rows[-1]
    while not names[-1]:
        names = names[:-1]
    return names


def _table(body: bytes, width: int, separator: str, line: int, source: Source) -> pa.Table:
    decimal = "," if separator != "," and re.search(rb"\d,\d", body) else "."
    mark = separator.encode()
    rows = [row.rstrip(b"\r") for row in body.split(b"\n")]
    # rows end with the last channel that still has samples: fill them up
    full = [row + mark * (width - 1 - row.count(mark)) for row in rows if row.strip() and row.strip() != b"EOF"]
    try:
        return parse_columns(b"\n".join(full), width, separator, decimal, nulls=_EMPTY)
    except pa.ArrowInvalid as error:
        raise _first_fault(rows, width, separator, decimal, line, source) from error


def _first_fault(rows: list[bytes], width: int, separator: str, decimal: str, line: int, source: Source) -> InputError:
    for number, row in enumerate(rows, line):
        cells = decode(row, f"{source.path}: line {number}").split(separator)
        if len(cells) > width:
            return InputError(f"{source.path}: line {number}", f"found {len(cells)} cells", f"allowed: at most {width}")
        for column, cell in enumerate(cells, 1):
            try:
                float(cell.strip().replace(decimal, ".") or 0.0)
            except ValueError:
                if row.strip() != b"EOF":
                    place = f"{source.path}: line {number}, cell {column}"
                    return InputError(place, f"found {cell.strip()!r}", "allowed: a number")
    return InputError(source.path, "found cells that are no numbers", "allowed: numbers")


def _filled(channel: Channel, column: pa.ChunkedArray) -> Channel:
    """The channel with its values up to its last; an empty cell before that is a defect."""
    array = column.to_numpy()
    present = np.flatnonzero(~np.isnan(array))
    first, stop = (int(present[0]), int(present[-1]) + 1) if present.size else (0, 0)
    line = (channel.line or 0) + first
    if present.size != stop - first:
        hole = first + int(np.argmax(np.isnan(array[first:stop])))
        defect = InputError(channel.place(hole), "found an empty cell", "allowed: a number")
        return replace(channel, line=line, defect=defect)
    return replace(channel, values=array[first:stop], line=line)


def _with_time(channel: Channel, time: Channel) -> Channel:
    defect = channel.defect or time.defect
    if defect is None and (channel.values.size != time.values.size or channel.line != time.line):
        found = f"found {channel.values.size} values and {time.values.size} times"
        defect = InputError(channel.place(), found, "allowed: as many of both; the file may be truncated")
    return replace(channel, time=time, defect=defect)


def _metadata(header: list[list[str]]) -> dict[str, str]:
    metadata = {"project": header[0][1]} if len(header[0]) > 1 else {}
    for cells in header:
        if cells[0].endswith("time of export") and len(cells) > 1 and cells[1].isdigit():
            # Windows FILETIME: steps of 100 ns since 1601
            moment = datetime(1601, 1, 1, tzinfo=UTC) + timedelta(microseconds=int(cells[1]) // 10)
            metadata[cells[0].lower()] = moment.isoformat()
    return metadata
