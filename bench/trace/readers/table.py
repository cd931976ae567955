"""Reader of tables in text, however they are laid out: one line of numbers per sample, and mostly names above them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pyarrow as pa
from pyarrow import csv

from bench.arrays import Array
from bench.errors import InputError
from bench.names import short
from bench.trace.channel import Channel, Recording, split_label
from bench.trace.readers.columns import floats
from bench.trace.readers.layout import BLANKS, EMPTY, HEAD, TableLayout, cells_of, find_layout, is_number
from bench.trace.readers.moments import compute, seconds
from bench.trace.source import Source, decode, utf8

#: Columns of a table; a recorder has some hundred channels at most.
MOST_COLUMNS = 10_000
_COMMENT = re.compile(rb"^[ \t]*(?:#|//)")

#: Of the kinds of columns; `exact` are epochs in ns with more digits than a float holds, and seconds to the ns.
TYPES = {"number": pa.float64(), "exact": pa.decimal128(30, 9), "text": pa.string()}


@dataclass(frozen=True)
class SampleLines:
    """Lines of samples in a text.

    Attributes:
        text: as UTF-8.
        line: number of the first of them in the file; None where lines were left out.
        notes: what the user should know.
        start: where in the text they start. A long text is not copied to be rid of its head.
    """

    text: bytes
    line: int | None
    notes: tuple[str, ...] = ()
    start: int = 0

    @cached_property
    def content(self) -> bytes:
        """The lines alone."""
        return self.text[self.start :]

    def parsed(self, kinds: Sequence[pa.DataType], layout: TableLayout, nulls: tuple[str, ...] = ()) -> pa.Table:
        """Columns of these types, named 0, 1, ...; ArrowInvalid where a line has another count of cells, or a cell is
        not of its type."""
        types = {str(number): kind for number, kind in enumerate(kinds)}
        return csv.read_csv(
            pa.py_buffer(memoryview(self.text)[self.start :]),
            read_options=csv.ReadOptions(column_names=list(types)),
            parse_options=csv.ParseOptions(delimiter=layout.delimiter, quote_char='"'),
            convert_options=csv.ConvertOptions(
                column_types=types, null_values=list(nulls), strings_can_be_null=False, decimal_point=layout.decimal
            ),
        )


class TextTable:
    """Tables in text, see the module."""

    format = "CSV table"
    endings = (".csv", ".txt", ".tsv", ".dat", ".log", ".asc", ".lvm")

    def recognises(self, source: Source) -> bool:
        """Whether lines of numbers follow one another in a text."""
        if "\0" in source.head or source.head.lstrip().startswith(("{", "[{", "<")):
            return False
        return _layout(source) is not None

    def read(self, source: Source) -> Recording:
        """Recording of a table.

        Raises:
            InputError: no samples, or a line with too few or too many cells.
        """
        layout = _layout(source)
        if layout is None:
            raise _no_table(source)
        content = utf8(source.content)
        lines = SampleLines(content, layout.start + 1, start=_offset(content, layout.start))
        channels, notes = read_lines(lines, layout, source.path)
        return Recording(channels, self.format, source.path, notes=notes)


def read_lines(lines: SampleLines, layout: TableLayout, path: str) -> tuple[tuple[Channel, ...], tuple[str, ...]]:
    """Channels of lines of samples, of whatever preamble they stand under, and what the user should know.

    Raises:
        InputError: too many columns, or a line with too few or too many cells; names `path` and the line.
    """
    if len(layout.labels) > MOST_COLUMNS:
        raise InputError(path, f"found {len(layout.labels)} columns", f"allowed: {MOST_COLUMNS}")
    if layout.separator == BLANKS:
        lines = SampleLines(_between_tabs(lines.content), lines.line)
    table, lines = parsed(lines, layout, path)
    rows = _filled_rows(table)
    gaps = _has_blank_lines(lines, table.num_rows) or (rows is not None and not rows[: int(rows.sum())].all())
    line = None if gaps else lines.line
    table = table if rows is None else table.filter(pa.array(rows))
    return tuple(_channels(table, layout, line, path)), lines.notes


def read_timed(lines: Sequence[str], line: int, layout: TableLayout, path: str) -> tuple[Channel, ...]:
    """Channels of lines whose column called `time` is the time of the others; a decimal comma is a point.

    Args:
        lines: of samples, without what stands above them.
        line: number of the first of them in the file.
        layout: of them.
        path: of the file.

    Raises:
        InputError: as `read_lines`, or a text among the times.
    """
    text = "\n".join(lines).replace(",", ".").encode()
    channels, _ = read_lines(SampleLines(text, line), layout, path)
    time = next(channel for channel in channels if channel.name == "time")
    if time.defect is not None:
        raise time.defect
    return tuple(replace(channel, time=time) for channel in channels if channel is not time)


def _has_blank_lines(lines: SampleLines, rows: int) -> bool:
    """Whether a line between samples is blank; where every line is a row none is, and to count lines takes no time."""
    if lines.text.count(b"\n", lines.start) + (not lines.text.endswith(b"\n")) == rows:
        return False
    return re.search(rb"\n[ \t\r]*\n", lines.content.rstrip()) is not None


def _layout(source: Source) -> TableLayout | None:
    head = utf8(source.content[:HEAD]).decode("utf-8", errors="replace")
    lines = head.split("\n")
    return find_layout([line.rstrip("\r") for line in (lines if len(source.content) <= HEAD else lines[:-1])])


def _no_table(source: Source) -> InputError:
    lines = [line for line in source.head.splitlines() if line.strip()]
    if len(lines) > 1 and all(is_number(line.strip()) for line in lines[1:10]):
        return InputError(
            f"{source.path}: line 1", "found one column", "allowed: at least two, one of them velocity or position"
        )
    return InputError(source.path, "found a header and no samples", "allowed: at least two samples")


def _offset(content: bytes, line: int) -> int:
    start = 0
    for _ in range(line):
        start = content.find(b"\n", start) + 1
    return start


def _between_tabs(body: bytes) -> bytes:
    """Columns between runs of blanks as columns between tabs."""
    return re.sub(rb"[ \t]+", b"\t", re.sub(rb"(?m)^[ \t]+|[ \t]+\r?$", b"", body))


def parsed(lines: SampleLines, layout: TableLayout, path: str) -> tuple[pa.Table, SampleLines]:
    """Columns as their kinds say, all as text where a cell is not as its kind; and the lines that they are of.

    Raises:
        InputError: a line with too few or too many cells, or a quote that is not closed.
    """
    try:
        return lines.parsed([TYPES[kind] for kind in layout.kinds], layout, EMPTY), lines
    except pa.ArrowInvalid:
        lines = _cleaned(lines, layout, path)
    try:
        return lines.parsed([pa.string()] * len(layout.labels), layout), lines
    except pa.ArrowInvalid as error:
        first = lines.line or 1
        numbered = enumerate(lines.content.splitlines(), first)
        quoted = next((number for number, line in numbered if line.count(b'"') % 2), first)
        raise InputError(f"{path}: line {quoted}", "found a quote that is not closed", "allowed: numbers") from error


def _cleaned(lines: SampleLines, layout: TableLayout, path: str) -> SampleLines:
    """Lines of samples without comments and blank lines among them, and without what a recorder writes below.

    Raises:
        InputError: a line with too few or too many cells.
    """
    separator, width = layout.delimiter, len(layout.labels)
    numbered = list(enumerate(lines.content.splitlines(), lines.line or 1))
    kept = [(number, line) for number, line in numbered if line.strip(b' \t\r"') and not _COMMENT.match(line)]
    comments = sum(1 for _, line in numbered if _COMMENT.match(line))
    while kept and not _holds_number(kept[-1][1], separator):
        kept.pop()
    below = sum(
        1 for number, line in numbered if kept and number > kept[-1][0] and line.strip() and not _COMMENT.match(line)
    )
    for number, line in kept:
        found = line.count(separator.encode()) + 1
        if found != width:
            cells = cells_of(decode(line), separator) if b'"' in line else [""] * found
            if len(cells) != width:
                raise InputError(
                    f"{path}: line {number}",
                    f"found {len(cells)} cell{'s' * (len(cells) > 1)}",
                    f"allowed: {width}, as the header has",
                )
    left_out = {"comment": comments, "line below the samples": below}
    notes = tuple(
        f"{count} {what}{'s' * (count > 1 and what == 'comment')} left out" for what, count in left_out.items() if count
    )
    whole = not kept or kept[-1][0] - kept[0][0] == len(kept) - 1
    text = b"\n".join(line for _, line in kept) + b"\n"
    return SampleLines(text, kept[0][0] if whole and kept else None, notes)


def _holds_number(line: bytes, separator: str) -> bool:
    return any(is_number(cell) for cell in cells_of(line.decode("utf-8", errors="replace"), separator))


def _filled_rows(table: pa.Table) -> np.ndarray | None:
    """Which rows hold anything; None: all."""
    filled = np.zeros(table.num_rows, dtype=bool)
    for column in table.columns:
        if pa.types.is_string(column.type):
            pc = compute()
            blank = pc.equal(pc.utf8_trim_whitespace(column), "").to_numpy()
            filled |= ~blank.astype(bool)
        elif not column.null_count:
            return None
        else:
            filled |= ~column.is_null().to_numpy()
        if filled.all():
            return None
    return filled


def _channels(table: pa.Table, layout: TableLayout, line: int | None, path: str) -> Iterator[Channel]:
    unnamed = [label == f"column {number}" for number, label in enumerate(layout.labels, 1)]
    for label, column, plain in zip(layout.labels, table.columns, unnamed, strict=True):
        channel = channel_of_cells(label, column, layout.decimal, path, line)
        holds = channel.defect is not None or np.isfinite(channel.values).any()
        if holds or not plain or all(unnamed):
            yield channel


def channel_of_cells(label: str, column: pa.ChunkedArray, decimal: str, path: str, line: int | None) -> Channel:
    """Channel of a column as `parsed` returns it; a defect where it holds a cell that is no number."""
    name, unit = split_label(label)
    channel = Channel(name, unit, np.empty(0), path, line=line)
    if pa.types.is_string(column.type):
        return _of_text(channel, column, decimal)
    if pa.types.is_decimal(column.type):
        return replace(channel, values=_from_first(column))
    return replace(channel, values=floats(column))


def _from_first(column: pa.ChunkedArray) -> Array:
    """Numbers of many digits as what they exceed the first one by, exactly."""
    first = column.drop_null()[0] if column.null_count < len(column) else None
    if first is None:
        return np.full(len(column), np.nan)
    return floats(compute().subtract(column, first))


def _of_text(channel: Channel, column: pa.ChunkedArray, decimal: str) -> Channel:
    """A channel of cells that are not all plain numbers: moments, truths, or numbers written at length."""
    moments = seconds(column)
    if moments is not None:
        return replace(channel, unit="s", values=moments, moments=True)
    pc = compute()
    texts = pc.utf8_trim_whitespace(column)
    filled = pc.if_else(pc.is_in(texts, pa.array(EMPTY)), "nan", texts)
    lower = pc.utf8_lower(filled)
    filled = pc.if_else(pc.equal(lower, "true"), "1", pc.if_else(pc.equal(lower, "false"), "0", filled))
    plain = _without_groups(filled, decimal)
    try:
        return replace(channel, values=floats(pc.cast(plain, pa.float64())))
    except pa.ArrowInvalid:
        sample = next(n for n, text in enumerate(plain.to_pylist()) if not _is_float(text))
        found = f"found {short(texts[sample].as_py())!r}"
        return replace(channel, defect=InputError(channel.place(sample), found, "allowed: a number"))


def _without_groups(texts: pa.ChunkedArray, decimal: str) -> pa.ChunkedArray:
    """Numbers without marks between thousands, and with a decimal point."""
    pc = compute()
    group = r"\." if decimal == "," else ","
    grouped = pc.match_substring_regex(
        texts, rf"^[+-]?\d{{1,3}}(?:[{group}'’ \x{{00a0}}\x{{202f}}]\d{{3}})+(?:{re.escape(decimal)}\d*)?$"
    )
    bare = pc.replace_substring_regex(texts, rf"[{group}'’ \x{{00a0}}\x{{202f}}]", "")
    plain = pc.if_else(grouped, bare, texts)
    return pc.replace_substring(plain, ",", ".") if decimal == "," else plain


def _is_float(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
