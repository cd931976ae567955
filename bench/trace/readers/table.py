"""Reader of tables in text: one header line `name [unit],...`, then one line of numbers per sample (canonical CSV)."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from bench.errors import InputError
from bench.trace.channel import Channel, Recording, float_values, split_label
from bench.trace.readers.columns import parse_columns
from bench.trace.source import Source, decode

FORMAT = "CSV table"
ENDINGS = (".csv", ".txt", ".tsv")

#: Columns of a table; a recorder has some hundred channels at most.
MOST_COLUMNS = 10_000
_SEPARATORS = (",", ";", "\t")
_NUMBER = re.compile(r"\s*[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?\s*")
_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d+,\d+\s*")


@dataclass(frozen=True)
class Layout:
    """How a table is written.

    Attributes:
        labels: of the columns.
        separator, decimal: characters between columns and in numbers.
        start: offset of the first line of numbers - bytes.
        line: its number in the file.
    """

    labels: tuple[str, ...]
    separator: str
    decimal: str
    start: int
    line: int


def recognises(source: Source) -> bool:
    """Whether the first line names several columns, one of them a time or with a unit, and text follows."""
    first = next((line for line in source.head.splitlines() if line.strip()), "")
    if "\0" in source.head or "\ufffd" in first:
        return False
    cells = re.split("[,;\t]", first)
    named = [cell for cell in cells if cell.strip() and not _NUMBER.fullmatch(cell)]
    return len(cells) > 1 and len(named) >= len(cells) - 1 and first.lstrip()[:1] not in "{[<"


def read(source: Source) -> Recording:
    """Recording of a table.

    Raises:
        InputError: no header, no samples, a line with too few or too many cells, or not UTF-8.
    """
    layout = _layout(source)
    body = source.content[layout.start :]
    table = numbers(body, layout, source.path)
    has_blank_lines = re.search(rb"\n[ \t\r]*\n", body.rstrip()) is not None
    channels = tuple(
        _channel(label, column, layout, source, None if has_blank_lines else layout.line)
        for label, column in zip(layout.labels, table.columns, strict=True)
    )
    return Recording(channels, FORMAT, source.path)


def _layout(source: Source) -> Layout:
    start, line = 0, 1
    while True:
        end = source.content.find(b"\n", start)
        end = len(source.content) if end < 0 else end
        if source.content[start:end].strip():
            break
        start, line = end + 1, line + 1
    header = decode(source.content[start:end], source.path).strip("\r\n")
    separator = max(_SEPARATORS, key=header.count)
    labels = tuple(label.strip().strip('"').strip() for label in header.split(separator))
    if len(labels) == 1:
        raise InputError(
            f"{source.path}: line {line}", "found one column", "allowed: a first line 'time [unit],name [unit],...'"
        )
    if len(labels) > MOST_COLUMNS:
        raise InputError(source.path, f"found {len(labels)} columns", f"allowed: {MOST_COLUMNS}")
    if all(_NUMBER.fullmatch(label) for label in labels):
        raise InputError(
            f"{source.path}: line {line}", "found numbers, no header", "allowed: a first line 'name [unit],...'"
        )
    if not source.content[end:].strip():
        raise InputError(source.path, "found a header and no samples", "allowed: at least two samples")
    first = next(iter(source.content[end : end + 4096].decode(errors="replace").lstrip().splitlines()), "")
    comma = separator != "," and any(_DECIMAL_COMMA.fullmatch(cell) for cell in first.split(separator))
    labels = tuple(label or f"column {number}" for number, label in enumerate(labels, 1))
    return Layout(labels, separator, "," if comma else ".", end + 1, line + 1)


def numbers(body: bytes, layout: Layout, path: str) -> pa.Table:
    """Columns as float64; all as text where a cell is not a plain number.

    Raises:
        InputError: a line with too few or too many cells.
    """
    count = len(layout.labels)
    try:
        return parse_columns(body, [pa.float64()] * count, layout.separator, layout.decimal)
    except pa.ArrowInvalid:
        _check_widths(body, layout, path)
    decode(body, path)
    try:
        return parse_columns(body, [pa.string()] * count, layout.separator, layout.decimal)
    except pa.ArrowInvalid as error:
        quoted = next((n for n, line in enumerate(body.splitlines(), layout.line) if line.count(b'"') % 2), layout.line)
        raise InputError(f"{path}: line {quoted}", "found a quote that is not closed", "allowed: numbers") from error


def _check_widths(body: bytes, layout: Layout, path: str) -> None:
    for number, line in enumerate(body.splitlines(), layout.line):
        found = line.count(layout.separator.encode()) + 1
        if line.strip() and found != len(layout.labels):
            raise InputError(
                f"{path}: line {number}",
                f"found {found} cell{'s' * (found > 1)}",
                f"allowed: {len(layout.labels)}, as the header has",
            )


def _channel(label: str, column: pa.ChunkedArray, layout: Layout, source: Source, line: int | None) -> Channel:
    name, unit = split_label(label)
    if column.type == pa.float64():
        return Channel(name, unit, column.to_numpy(), source.path, line=line)
    channel = Channel(name, unit, np.empty(0), source.path, line=line)
    texts = [text.replace(layout.decimal, ".") for text in column.to_pylist()]
    try:
        return replace(channel, values=float_values(texts, channel.place))
    except InputError as defect:
        return replace(channel, defect=defect)
