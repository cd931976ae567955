"""Reader of tables in text, however they are laid out: one line of numbers per sample, and mostly names above them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute

from bench.arrays import Array
from bench.errors import InputError
from bench.names import short
from bench.trace.channel import Channel, Recording, split_label
from bench.trace.readers.columns import parse_columns
from bench.trace.readers.moments import seconds
from bench.trace.readers.table_layout import BLANKS, EMPTY, HEAD, Layout, cells_of, find_layout, is_number
from bench.trace.signal_names import signal_of, unit_of
from bench.trace.source import Source, decode, utf8
from bench.units.text import UnitError, scale_of

FORMAT = "CSV table"
ENDINGS = (".csv", ".txt", ".tsv", ".dat", ".log", ".asc", ".lvm")

#: Columns of a table; a recorder has some hundred channels at most.
MOST_COLUMNS = 10_000
_COMMENT = re.compile(rb"^[ \t]*(?:#|//)")
#: Its functions are made when it is loaded, so that checkers of types know none.
pc: Any = pyarrow.compute

#: Epochs in ns with more digits than a float holds, and seconds to the ns.
_EXACT = pa.decimal128(30, 9)
_GROUPS = re.compile(r"[+-]?\d{1,3}(?:[.,' ’\u00a0\u202f]\d{3})+")


@dataclass(frozen=True)
class Body:
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

    def parsed(self, kinds: list[pa.DataType], layout: Layout, nulls: tuple[str, ...] = ()) -> pa.Table:
        """Columns, as `parse_columns` has them."""
        return parse_columns(memoryview(self.text)[self.start :], kinds, _separator(layout), layout.decimal, nulls)


def recognises(source: Source) -> bool:
    """Whether lines of numbers follow one another in a text."""
    if "\0" in source.head or source.head.lstrip().startswith(("{", "[{", "<")):
        return False
    return _layout(source) is not None


def read(source: Source) -> Recording:
    """Recording of a table.

    Raises:
        InputError: no samples, or a line with too few or too many cells.
    """
    layout = _layout(source)
    if layout is None:
        raise _no_table(source)
    if len(layout.labels) > MOST_COLUMNS:
        raise InputError(source.path, f"found {len(layout.labels)} columns", f"allowed: {MOST_COLUMNS}")
    content = utf8(source.content)
    body = Body(content, layout.start + 1, start=_offset(content, layout.start))
    if layout.separator == BLANKS:
        body = Body(_between_tabs(body.content), body.line)
    table, body = _columns(body, layout, source.path)
    rows = _filled_rows(table)
    gaps = _has_blank_lines(body, table.num_rows) or (rows is not None and not rows[: int(rows.sum())].all())
    line = None if gaps else body.line
    table = table if rows is None else table.filter(pa.array(rows))
    channels = tuple(_channels(table, layout, line, source.path))
    return Recording(channels, FORMAT, source.path, notes=body.notes)


def _has_blank_lines(body: Body, rows: int) -> bool:
    """Whether a line between samples is blank; where every line is a row none is, and to count lines takes no time."""
    if body.text.count(b"\n", body.start) + (not body.text.endswith(b"\n")) == rows:
        return False
    return re.search(rb"\n[ \t\r]*\n", body.content.rstrip()) is not None


def _layout(source: Source) -> Layout | None:
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


def _separator(layout: Layout) -> str:
    return "\t" if layout.separator == BLANKS else layout.separator


def _columns(body: Body, layout: Layout, path: str) -> tuple[pa.Table, Body]:
    """Columns as their kinds say; all as text where a cell is not as its kind."""
    types = {"number": pa.float64(), "exact": _EXACT, "text": pa.string()}
    separator, count = _separator(layout), len(layout.labels)
    try:
        kinds = [
            types["number" if kind == "exact" and not _may_be_time(label) else kind]
            for kind, label in zip(layout.kinds, layout.labels, strict=True)
        ]
        return body.parsed(kinds, layout, EMPTY), body
    except pa.ArrowInvalid:
        body = _cleaned(body, separator, count, path)
    try:
        return body.parsed([pa.string()] * count, layout), body
    except pa.ArrowInvalid as error:
        first = body.line or 1
        lines = enumerate(body.content.splitlines(), first)
        quoted = next((number for number, line in lines if line.count(b'"') % 2), first)
        raise InputError(f"{path}: line {quoted}", "found a quote that is not closed", "allowed: numbers") from error


def _cleaned(body: Body, separator: str, width: int, path: str) -> Body:
    """Lines of samples without comments and blank lines among them, and without what a recorder writes below.

    Raises:
        InputError: a line with too few or too many cells.
    """
    first = body.line or 1
    numbered = [(number, line) for number, line in enumerate(body.content.splitlines(), first)]
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
    return Body(b"\n".join(line for _, line in kept) + b"\n", kept[0][0] if whole and kept else None, notes)


def _holds_number(line: bytes, separator: str) -> bool:
    return any(is_number(cell) for cell in cells_of(line.decode("utf-8", errors="replace"), separator))


def _filled_rows(table: pa.Table) -> np.ndarray | None:
    """Which rows hold anything; None: all."""
    filled = np.zeros(table.num_rows, dtype=bool)
    for column in table.columns:
        if pa.types.is_string(column.type):
            blank = pc.equal(pc.utf8_trim_whitespace(column), "").to_numpy()
            filled |= ~blank.astype(bool)
        elif not column.null_count:
            return None
        else:
            filled |= ~column.is_null().to_numpy()
        if filled.all():
            return None
    return filled


def _channels(table: pa.Table, layout: Layout, line: int | None, path: str) -> Iterator[Channel]:
    for number, (label, column) in enumerate(zip(layout.labels, table.columns, strict=True), 1):
        name, unit = split_label(label)
        channel = Channel(name or f"column {number}", unit, np.empty(0), path, line=line)
        if pa.types.is_string(column.type):
            channel = _of_text(channel, column, layout.decimal)
        elif pa.types.is_decimal(column.type):
            channel = replace(channel, values=_from_first(column))
        else:
            channel = replace(
                channel, values=column.fill_null(np.nan).to_numpy() if column.null_count else column.to_numpy()
            )
        unnamed = label == f"column {number}" and channel.defect is None and not np.isfinite(channel.values).any()
        if not unnamed or layout.labels == tuple(f"column {n}" for n in range(1, len(layout.labels) + 1)):
            yield channel


def _may_be_time(label: str) -> bool:
    """Whether a column may hold instants, of which only the distances count: not one of a signal or another unit."""
    name, unit = split_label(label)
    if signal_of(name) not in (None, "time"):
        return False
    try:
        return unit_of(unit) is None or scale_of(str(unit), ("s",)) is not None
    except UnitError:
        return False


def _from_first(column: pa.ChunkedArray) -> Array:
    """Numbers of many digits as what they exceed the first one by, exactly."""
    first = column.drop_null()[0] if column.null_count < len(column) else None
    if first is None:
        return np.full(len(column), np.nan)
    return pc.cast(pc.subtract(column, first), pa.float64()).fill_null(np.nan).to_numpy()


def _of_text(channel: Channel, column: pa.ChunkedArray, decimal: str) -> Channel:
    """A channel of cells that are not all plain numbers: moments, truths, or numbers written at length."""
    moments = seconds(column)
    if moments is not None:
        return replace(channel, unit="s", values=moments, moments=True)
    texts = pc.utf8_trim_whitespace(column)
    filled = pc.if_else(pc.is_in(texts, pa.array(EMPTY)), "nan", texts)
    lower = pc.utf8_lower(filled)
    filled = pc.if_else(pc.equal(lower, "true"), "1", pc.if_else(pc.equal(lower, "false"), "0", filled))
    plain = _without_groups(filled, decimal)
    try:
        return replace(channel, values=pc.cast(plain, pa.float64()).to_numpy())
    except pa.ArrowInvalid:
        sample = next(n for n, text in enumerate(plain.to_pylist()) if not _is_float(text))
        found = f"found {short(texts[sample].as_py())!r}"
        return replace(channel, defect=InputError(channel.place(sample), found, "allowed: a number"))


def _without_groups(texts: pa.ChunkedArray, decimal: str) -> pa.ChunkedArray:
    """Numbers without marks between thousands, and with a decimal point."""
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
