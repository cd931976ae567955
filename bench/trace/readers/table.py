"""Reader of tables in text, however they are laid out: one line of numbers per sample, and mostly names above them.

The samples determine the layout: of the separators, the one that cuts the most numbers out of the last lines of the
head. The first line that is like them begins the samples; above it stand, in this order and each if at all, a
preamble, the header and a row of units.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa
import pyarrow.csv

from bench.bounds import require_columns
from bench.errors import InputError
from bench.names import short
from bench.trace.assumed import assumed_units
from bench.trace.channel import Channel, Recording, split_label, with_units
from bench.trace.readers.arrow import channels_of_table, compute, floats, seconds, speaks_of_moment
from bench.trace.signals import plain_name, signal_of, unit_of
from bench.trace.source import FileFormat, Source, decode, no_samples, utf8
from bench.units.conversion import is_unit, scale_or_none

BLANKS = " "
SEPARATORS = ("\t", ";", ",", BLANKS)
#: Texts that stand for no number.
EMPTY = (
    *("", " ", "-", "--", "---", "?", "*", "null", "NULL", "None", "NA", "N/A", "#N/A", "n/a"),
    *("nan", "NaN", "NAN", "Nan", "-nan", "-NaN", "nan(ind)", "-nan(ind)", "1.#QNAN"),
)
#: Characters of the head that are looked at, and lines at its end that show what samples are like.
HEAD, SHOWN, FEW = 1 << 18, 60, 8
#: Numbers a line times their share of its cells, up to which lines are prose with a number in it.
PROSE = 0.15
#: Joints that take turns in the lines of a file, and the share of the lines in which they do.
MOST_JOINTS, IN_TURN = 64, 0.9
#: Of the kinds of columns; `list` is one of numbers; `exact` are epochs in ns with more digits than a float has, and
#: seconds to the ns.
TYPES = {"number": pa.float64(), "exact": pa.decimal128(30, 9), "text": pa.string(), "list": pa.string()}

_NUMBER = re.compile(r"[+-]?(?:\d[\d.,'’\u00a0\u202f]*(?<!,)|[.,]\d+)(?:[eE][+-]?\d+)?")
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?|[+-]?\d{1,3}(?:[.'’\u00a0\u202f]\d{3})+,\d*")
_WORDS = frozenset(("true", "false", "inf", "-inf", "+inf", "infinity", "-infinity"))
_LEADING = re.compile(r"^\s*(?:#+|//+|!+|%+(?=\s))\s*")
_EXACT = re.compile(r"[+-]?\d{16,}|[+-]?\d{9,}[.,]\d{4,9}")
_LIST = re.compile(r"[\[(]\s*[-+\d.][-+\d.eE,;\s]*[\])]")
_NUMBERED = re.compile(r"(?:^|_)(?:joint|motor|servo|actuator|axis|id)(?:_?(?:id|index|number|no))?$", re.IGNORECASE)
#: `iq_lft[A]: 2.36`, `w=1,5 rad/s`: a label, a value and perhaps a unit, which no next label is.
_PAIR = re.compile(
    r"(?<![^\W\d])([^\W\d][^\s:=,;|]{0,100}+(?: ?\[[^\]\s]{0,30}\])?)\s*[:=]\s*"
    r"([+-]?(?:\d+(?:[.,]\d+)?|[.,]\d+)(?:[eE][+-]?\d+)?|nan|NaN)(?![.\d:])"
    r"(?:\s?([^\W\d][^\s:=,;|\[]*|[%°][^\s:=,;|\[]*)(?!\s*[:=\[]|[^\s,;|]))?"
)
#: What a log has in front of them: words, and among these a time.
_WORD = r"(?:[\[(<]?[^\W\d]\w*+[\])>]?[:,|>\s-]++)*+"
_FRONT = re.compile(
    rf"\s*+{_WORD}(?:[\[(<]?((?:\d{{4}}-\d\d-\d\d[T ])?\d+:\d\d:\d\d(?:[.,]\d+)?|\d+(?:[.,]\d+)?)\s?(s|ms|us|µs)?"
    rf"[\])>]?[:,;|>\s-]++)?{_WORD}"
)
#: Blanks before a name; a unit in brackets, behind a slash or behind `in` belongs to the name before it.
_BEFORE_A_NAME = re.compile(r"\s+(?![\[(/]|in\s)(?<!/\s)(?<!\sin\s)")
_COMMENT = re.compile(rb"^[ \t]*(?:#|//)")


@dataclass(frozen=True)
class TableLayout:
    """How a table is written.

    Attributes:
        labels: of the columns, with their units.
        separator, decimal: characters between columns and in numbers; BLANKS: any run of them.
        start: line of the first samples, counted from 0.
        kinds: of each column: `number`, `exact` (instants of more digits than a float has), `text`.
        head: lines above the samples, which a recorder that starts again writes again.
    """

    labels: tuple[str, ...]
    separator: str
    decimal: str
    start: int
    kinds: tuple[str, ...]
    head: frozenset[str] = frozenset()

    @property
    def delimiter(self) -> str:
        """The one character between columns, once runs of blanks are tabs."""
        return "\t" if self.separator == BLANKS else self.separator


def _recognises(source: Source) -> bool:
    marked_up = "\0" in source.head or source.head.lstrip().startswith(("{", "[{", "<"))
    return not marked_up and (_layout_of(source) is not None or bool(_labels_in(source.head.splitlines())))


def _read(source: Source) -> Recording:
    layout, notes = _layout_of(source), ()
    if labels := _labels_in(source.head.splitlines()):
        source, notes = _unlabelled(source, labels)
        layout = _layout_of(source)
    if layout is None:
        raise _no_table(source)
    _require_separate(layout, source.path)
    samples = utf8(source.content).split(b"\n", layout.start)[-1]
    channels, found = read_lines(samples, layout.start + 1, layout, source.path)
    return Recording(channels, TABLE.format, source.path, notes=(*notes, *found))


def _require_separate(layout: TableLayout, path: str) -> None:
    """InputError where decimal commas stand between commas, so that lines have more cells than there are names."""
    width = len(layout.labels)
    names = max((len(cells_of(line, ",")) for line in layout.head), default=0)
    if (
        layout.separator == ","
        and names < width <= 2 * names
        and all(label.startswith("column ") for label in layout.labels)
    ):
        found = f"found {width} cells under {names} names: numbers with decimal commas, and commas between them"
        allowed = "allowed: semicolons or tabs between numbers with decimal commas, or decimal points"
        raise InputError(f"{path}: line {layout.start + 1}", found, allowed)


def _no_table(source: Source) -> InputError:
    """Why a text is no table."""
    lines = [(number, line) for number, line in enumerate(source.text().splitlines(), 1) if line.strip()]
    if len(lines) > 1 and all(is_number(line.strip()) for _, line in lines[1:10]):
        allowed = "allowed: at least two, one of them velocity or position"
        return InputError(f"{source.path}: line 1", "found one column", allowed)
    number, last = lines[-1]
    if not any(char.isdigit() for _, line in lines[1:] for char in line):
        return no_samples(source)
    allowed = (
        "allowed: a line for each sample, with as many numbers in each, between commas, semicolons, tabs or blanks"
    )
    return InputError(f"{source.path}: line {number}", f"found no columns of numbers: {short(last)!r}", allowed)


def _labels_in(lines: list[str]) -> tuple[str, ...]:
    """Labels of lines such as `speed[rpm]:12 iq:0.5`, which most lines have; none where the lines are not like that."""
    shown = [line for line in lines if line.strip()][-SHOWN:]
    found = Counter(tuple(label for label, _ in pairs) for line in shown if (pairs := _pairs_of(line)))
    labels, often = found.most_common(1)[0] if found else ((), 0)
    return labels if len(set(labels)) > 1 and often > 0.5 * len(shown) else ()


def _pairs_of(line: str) -> list[tuple[str, str]]:
    """Labels, with the unit behind the value where that has one, and values of a line that consists of them; in front
    of them may be words, and a time."""
    pairs = list(_PAIR.finditer(line))
    if len(pairs) < 2 or _PAIR.sub("", line[pairs[0].start() :]).strip(" \t\r,;|&{}"):
        return []
    front = _FRONT.fullmatch(line[: pairs[0].start()].strip(" \t\r,;|&{") + " ")
    if front is None:
        return []
    found = [(f"{one[1]} [{one[3]}]" if one[3] and "[" not in one[1] else one[1], one[2]) for one in pairs]
    if front[1] and all(signal_of(split_label(label)[0]) != "time" for label, _ in found):
        found.insert(0, (f"time [{front[2]}]" if front[2] else "time", front[1]))
    return found


def _unlabelled(source: Source, labels: Sequence[str]) -> tuple[Source, tuple[str, ...]]:
    """The same as a table under a header; lines without these labels are left out."""
    rows = [dict(_pairs_of(line)) for line in source.text().splitlines()]
    kept = ["\t".join(row[label].replace(",", ".") for label in labels) for row in rows if set(labels) <= set(row)]
    content = "\n".join(("\t".join(labels), *kept, "")).encode()
    count = len(rows) - len(kept)
    return replace(source, content=content), (
        (f"{count} line{'s' * (count > 1)} without all labels left out",) if count else ()
    )


TABLE = FileFormat("CSV table", (".csv", ".txt", ".tsv", ".dat", ".log", ".asc", ".lvm"), _recognises, _read)


def read_lines(text: bytes, line: int, layout: TableLayout, path: str) -> tuple[tuple[Channel, ...], tuple[str, ...]]:
    """Channels of lines of samples, the first of which has the number `line`, and what the user should know.

    Raises:
        InputError: too many columns, a line with too few or too many cells, or a quote that is not closed; names
            `path` and the line.
    """
    require_columns(path, len(layout.labels))
    if layout.separator == BLANKS:
        text = re.sub(rb"[ \t]+", b"\t", re.sub(rb"(?m)^[ \t]+|[ \t]+\r?$", b"", text))
    table, first, notes = parsed(text, line, layout, path)
    filled = _filled_rows(table)
    if not filled.all():
        first = first if filled[: filled.sum()].all() else None
        table = table.filter(pa.array(filled))
    of_joints = _of_joints(table, layout, path)
    if of_joints is not None:
        return of_joints, notes
    unnamed = [label == f"column {number}" for number, label in enumerate(layout.labels, 1)]
    kept: list[Channel] = []
    columns = zip(layout.labels, table.columns, layout.kinds, unnamed, strict=True)
    for number, (label, column, kind, plain) in enumerate(columns, 1):
        lists = as_lists(column) if kind == "list" else None
        if lists is not None:
            kept.extend(channels_of_table(pa.table({label: lists}), path))
            continue
        channel = replace(channel_of_cells(label, column, layout.decimal, path, first), number=number)
        if not plain or all(unnamed) or channel.defect is not None or np.isfinite(channel.values).any():
            kept.append(channel)
    channels, assumed = _with_own_times(with_units(kept))
    return channels, (*notes, *assumed)


def _with_own_times(channels: Sequence[Channel]) -> tuple[tuple[Channel, ...], tuple[str, ...]]:
    """The same, each signal with the times in front of it, as `X, Y, X, Y` has them; and what was assumed."""
    first = plain_name(channels[0].name) if channels else ""
    times = [one for one in channels if plain_name(one.name) == first]
    timed = len(times) > 1 and (first == "x" or signal_of(first) == "time")
    if not timed or any(one.values.size < 2 or not (np.diff(one.values) > 0).all() for one in times):
        return tuple(channels), ()
    if all(np.array_equal(one.values, times[0].values) for one in times):
        return tuple(one for one in channels if one is times[0] or one not in times), ()
    assumed = assumed_units({"time": times[0]}, {"time": times[0].unit}, bare=True).units
    times = [replace(one, unit=one.unit or assumed.get("time")) for one in times]
    if any(one.unit is None for one in times):
        return tuple(channels), ()
    found: list[Channel] = []
    for one in channels:
        time = next(time for time in reversed(times) if (time.number or 0) <= (one.number or 0))
        found += [replace(one, time=time)] if one.number != time.number else []
    return tuple(found), tuple(f"times taken as {unit}, as the file has no unit" for unit in assumed.values())


def _of_joints(table: pa.Table, layout: TableLayout, path: str) -> tuple[Channel, ...] | None:
    """Channels of joints that take turns in the lines, `joint.column` or `joint`, with times of their own; else None.

    A column of texts, or of such a name, names the joint of each line.
    """
    columns = list(zip(layout.labels, table.columns, layout.kinds, strict=True))
    for label, column, kind in columns:
        if kind == "text" or _NUMBERED.search(label):
            encoded = compute().dictionary_encode(column.combine_chunks())
            which = encoded.indices.fill_null(0).to_numpy(zero_copy_only=False)
            names = [f"{name:g}" if isinstance(name, float) else str(name) for name in encoded.dictionary.to_pylist()]
            turns = len(names)
            if 2 <= turns <= MOST_JOINTS and which.size >= 4 * turns:
                again, other = which[turns:] == which[:-turns], which[turns:] != which[turns - 1 : -1]
                if float(np.mean(again & other)) >= IN_TURN:
                    break
    else:
        return None
    others = [(name, cells) for name, cells, kind in columns if cells is not column and kind != "text"]
    alone = sum(signal_of(split_label(name)[0]) != "time" for name, _ in others) == 1
    found: list[Channel] = []
    for k, joint in enumerate(names):
        own = pa.array(which == k)
        channels = [channel_of_cells(name, cells.filter(own), layout.decimal, path, None) for name, cells in others]
        if not alone:
            found += [replace(channel, name=f"{joint}.{channel.name}", axis=joint) for channel in channels]
            continue
        time = next((channel for channel in with_units(channels) if signal_of(channel.name) == "time"), None)
        found += [replace(one, name=joint, time=time) for one in channels if signal_of(one.name) != "time"]
    return tuple(found)


def as_lists(cells: pa.ChunkedArray) -> pa.ChunkedArray | None:
    """Cells such as `[0.1, 0.2]` as lists of numbers; None where one is no list of numbers."""
    pc = compute()
    bare = pc.replace_substring_regex(pc.utf8_trim(cells, " []()"), r"[,;\s]+", ",")
    try:
        return pc.cast(pc.split_pattern(bare, ","), pa.list_(pa.float64()))
    except pa.ArrowInvalid:
        return None


def read_timed(lines: Sequence[str], line: int, labels: Sequence[str], separator: str, path: str) -> list[Channel]:
    """Channels of lines of numbers whose column called `time` is the time of the others; a decimal comma is a point.

    Raises:
        InputError: as `read_lines`, no column of that name, or a text among the times.
    """
    layout = TableLayout(tuple(labels), separator, ".", 0, ("number",) * len(labels))
    channels, _ = read_lines("\n".join(lines).replace(",", ".").encode(), line, layout, path)
    time = next((channel for channel in channels if channel.name == "time"), None)
    if time is None:
        raise InputError(path, f"found columns {', '.join(labels)}", "allowed: one of them called time")
    if time.defect is not None:
        raise time.defect
    return [replace(channel, time=time) for channel in channels if channel is not time]


def _arrow_table(text: bytes, kinds: Sequence[pa.DataType], layout: TableLayout, nulls: Sequence[str]) -> pa.Table:
    """Columns of these types; ArrowInvalid where a line has another count of cells, or a cell is not of its type."""
    types = {str(number): kind for number, kind in enumerate(kinds)}
    return pyarrow.csv.read_csv(
        pa.py_buffer(text),
        read_options=pyarrow.csv.ReadOptions(column_names=list(types)),
        parse_options=pyarrow.csv.ParseOptions(delimiter=layout.delimiter, quote_char='"'),
        convert_options=pyarrow.csv.ConvertOptions(
            column_types=types, null_values=list(nulls), strings_can_be_null=False, decimal_point=layout.decimal
        ),
    )


def parsed(text: bytes, line: int, layout: TableLayout, path: str) -> tuple[pa.Table, int | None, tuple[str, ...]]:
    """Columns by their kinds, all as text where a cell is not as its kind; and what the user should know.

    Between them the line of the first row, None where not every line from there on is a row; raises as `read_lines`.
    """
    try:
        table = _arrow_table(text, [TYPES[kind] for kind in layout.kinds], layout, EMPTY)
    except pa.ArrowInvalid:
        text, first, notes = _cleaned(text, line, layout, path)
    else:
        lines = text.count(b"\n") + (not text.endswith(b"\n"))  # to count them takes no time
        blank = lines != table.num_rows and re.search(rb"\n[ \t\r]*\n", text.rstrip()) is not None
        return table, None if blank else line, ()
    try:
        return _arrow_table(text, [pa.string()] * len(layout.labels), layout, ()), first, notes
    except pa.ArrowInvalid as error:
        first = first or 1
        numbered = enumerate(text.splitlines(), first)
        quoted = next((number for number, line in numbered if line.count(b'"') % 2), first)
        raise InputError(f"{path}: line {quoted}", "found a quote that is not closed", "allowed: numbers") from error


def _cleaned(text: bytes, line: int, layout: TableLayout, path: str) -> tuple[bytes, int | None, tuple[str, ...]]:
    """Lines without comments and blank lines among them, and without what a recorder writes below; else as `parsed`."""
    separator, width = layout.delimiter, len(layout.labels)
    numbered = list(enumerate(text.splitlines(), line))
    written = [(number, one) for number, one in numbered if one.strip() and not _COMMENT.match(one)]
    comments = sum(_COMMENT.match(one) is not None for _, one in numbered)
    again = {number for number, one in written if _one_blank(decode(one)) in layout.head}
    kept = [(number, one) for number, one in written if one.strip(b' \t\r"') and number not in again]
    while kept and _is_below(cells_of(decode(kept[-1][1]), separator), layout.kinds):
        kept.pop()
    below = sum(number > kept[-1][0] for number, _ in written) if kept else 0
    for number, one in kept:
        found = one.count(separator.encode()) + 1
        if found != width and b'"' in one:
            found = len(cells_of(decode(one), separator))
        if found != width:
            cells = f"found {found} cell{'s' * (found > 1)}"
            raise InputError(f"{path}: line {number}", cells, f"allowed: {width}, as the header has")
    left_out = {"comment{}": comments, "line{} below the samples": below, "line{} of a repeated header": len(again)}
    notes = tuple(f"{count} {what.format('s' * (count > 1))} left out" for what, count in left_out.items() if count)
    whole = kept and kept[-1][0] - kept[0][0] == len(kept) - 1
    return b"\n".join(one for _, one in kept) + b"\n", kept[0][0] if whole else None, notes


def _is_below(cells: Sequence[str], kinds: Sequence[str]) -> bool:
    """Whether a line is none of the samples: without a number, or with a word such as `Mean` where each has one."""
    word = kinds[0] != "text" and cells[:1] and cells[0] not in EMPTY and not is_number(cells[0])
    return not any(map(is_number, cells)) or (bool(word) and not speaks_of_moment(cells[0]) and cells[0][0].isalpha())


def _filled_rows(table: pa.Table) -> np.ndarray:
    """Which rows hold anything (n,)."""
    if any(not column.null_count and not pa.types.is_string(column.type) for column in table.columns):
        return np.ones(table.num_rows, dtype=bool)
    pc, filled = compute(), np.zeros(table.num_rows, dtype=bool)
    for column in table.columns:
        text = pa.types.is_string(column.type)
        known = pc.not_equal(pc.utf8_trim_whitespace(column), "") if text else column.is_valid()
        filled |= floats(known.cast(pa.uint8())) > 0.0
        if filled.all():
            break
    return filled


def channel_of_cells(label: str, column: pa.ChunkedArray, decimal: str, path: str, line: int | None) -> Channel:
    """Channel of a column as `parsed` returns it; a defect where it has a cell that is no number."""
    channel = Channel(*split_label(label), np.empty(0), path, line=line)
    if pa.types.is_string(column.type):
        return _of_text(channel, column, decimal)
    if pa.types.is_decimal(column.type):  # of many digits: what they exceed the first one by, exactly
        first = column.drop_null()[:1].to_pylist()
        column = compute().subtract(column, pa.scalar(first[0], column.type)) if first else column
    return replace(channel, values=floats(column))


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
    if plain is None:
        found = f"found decimal commas and decimal points in the column '{channel.name}'"
        return replace(channel, defect=InputError(channel.origin, found, "allowed: one of them"))
    try:
        return replace(channel, values=floats(pc.cast(plain, pa.float64())))
    except pa.ArrowInvalid:
        sample = next(number for number, text in enumerate(plain) if not _is_float(text))
        found = f"found {short(texts[sample].as_py())!r}"
        return replace(channel, defect=InputError(channel.place(sample), found, "allowed: a number"))


def _without_groups(texts: pa.ChunkedArray, decimal: str) -> pa.ChunkedArray | None:
    """Numbers without marks between thousands, and with a decimal point; None where a mark may be either.

    A file whose other numbers have a decimal comma may have points between thousands, or a column with decimal points.
    """
    pc = compute()
    mark = "." if decimal == "," else ","

    def written(pattern: str) -> pa.ChunkedArray:
        return pc.match_substring_regex(texts, rf"^[+-]?{pattern}(?:[eE][+-]?\d+)?$")

    def any_of(found: pa.ChunkedArray) -> bool:
        return bool(pc.any(found).as_py())

    other = re.escape(mark)
    # behind a zero, four digits, or in front of other than three digits no mark separates thousands
    if any_of(written(rf"(?:(?:0|\d{{4,}})?{other}\d+|\d+{other}(?:\d{{0,2}}|\d{{4,}}))")):
        return pc.replace_substring(texts, ",", ".")
    groups = rf"[{other}'’ \x{{00a0}}\x{{202f}}]"
    grouped = written(rf"\d{{1,3}}(?:{groups}\d{{3}})+(?:{re.escape(decimal)}\d*)?")
    if any_of(written(rf"\d{{1,3}}{other}\d{{3}}")) and any_of(written(rf"\d+{re.escape(decimal)}\d+")):
        return None
    bare = pc.replace_substring_regex(texts, groups, "")
    plain = pc.if_else(grouped, bare, texts)
    return pc.replace_substring(plain, ",", ".") if decimal == "," else plain


def _is_float(text: pa.Scalar) -> bool:
    try:
        text.cast(pa.float64())
    except pa.ArrowInvalid:
        return False
    return True


def _layout_of(source: Source) -> TableLayout | None:
    for size in (HEAD, 16 * HEAD):  # a header may be long
        lines = utf8(source.content[:size]).decode("utf-8", errors="replace").split("\n")
        whole = len(source.content) <= size
        layout = find_layout([line.rstrip("\r") for line in (lines if whole else lines[:-1])])
        if layout is not None or whole:
            return layout
    return None


def find_layout(lines: list[str]) -> TableLayout | None:
    """The layout of a table that begins with these lines; None where they show none."""
    filled = [line for line in lines if line.strip() and not _COMMENT.match(line.encode())]
    tails = (filled[-SHOWN:], filled[-FEW:])  # few samples below a long header
    shown, (separator, width) = next(((tail, cut) for tail in tails if (cut := _separator(tail))[1]), ([], ("", 0)))
    if not width:
        return None
    rows = [row for row in (cells_of(line, separator) for line in shown) if len(row) == width]
    kinds = [_kind(column) for column in zip(*rows, strict=True)]
    start = next((number for number in range(len(lines)) if _begins(lines, number, separator, kinds)), None)
    if start is None or not {"number", "exact", "list"} & set(kinds):
        return None
    decimal = "," if any(_DECIMAL_COMMA.fullmatch(cell) for row in rows for cell in row) else "."
    labels = _labels(lines[:start], separator, width)
    for place, label in enumerate(labels):
        if kinds[place] == "exact" and not _may_be_time(label):
            kinds[place] = "number"
    head = frozenset(_one_blank(line) for line in lines[:start] if any(map(str.isalpha, line)))
    return TableLayout(labels, separator, decimal, start, tuple(kinds), head)


def cells_of(line: str, separator: str) -> list[str]:
    """Cells of a line, without quotes."""
    text = _one_blank(line) if separator == BLANKS else line.replace("\r", "")
    try:
        row = next(csv.reader([text], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:  # longer than any cell of a recording
        return []
    return [cell.strip() for cell in row]


def _one_blank(line: str) -> str:
    return " ".join(line.split())


def is_number(cell: str) -> bool:
    """Whether a cell is a number in any of the usual ways of writing one."""
    return _NUMBER.fullmatch(cell) is not None or cell.lower() in _WORDS


def _may_be_time(label: str) -> bool:
    """Whether a column may hold instants, of which only the distances count: not one of a signal or another unit."""
    name, unit = split_label(label)
    if signal_of(name) not in (None, "time"):
        return False
    return unit_of(unit) is None or scale_or_none(str(unit), ("s",)) is not None


def _separator(shown: list[str]) -> tuple[str, int]:
    """Separator that cuts out the most numbers, and how many cells it makes; 0 where none makes two."""
    best, found = PROSE, (",", 0)
    for separator in SEPARATORS if shown else ():
        rows = [cells_of(line, separator) for line in shown]
        width, often = Counter(map(len, rows)).most_common(1)[0]
        if width < 2 or often < 0.5 * len(rows):
            continue
        cells = [cell for row in rows if len(row) == width for cell in row]
        count = [cell.count(",") + 1 if _LIST.fullmatch(cell) else 1 for cell in cells]
        plain = (cell in EMPTY or is_number(cell) or speaks_of_moment(cell) for cell in cells)
        values = sum(n for n, is_plain in zip(count, plain, strict=True) if n > 1 or is_plain)
        score = values / often * values / sum(count) * often / len(rows)
        if score > best:
            best, found = score, (separator, width)
    return found


def _kind(cells: tuple[str, ...]) -> str:
    filled = [cell for cell in cells if cell not in EMPTY]
    if filled and all(map(_LIST.fullmatch, filled)):
        return "list"
    if filled and sum(map(is_number, filled)) < 0.5 * len(filled):
        return "text"
    return "exact" if filled and all(map(_EXACT.fullmatch, filled)) else "number"


def _begins(lines: list[str], number: int, separator: str, kinds: Sequence[str]) -> bool:
    """Whether a line and the next one that is not blank are samples."""
    ahead = [line for line in lines[number : number + 8] if line.strip()][:2]
    return bool(lines[number].strip()) and all(_is_sample(cells_of(line, separator), kinds) for line in ahead)


def _is_sample(cells: list[str], kinds: Sequence[str]) -> bool:
    if len(cells) != len(kinds):
        return False
    numeric = [cell for cell, kind in zip(cells, kinds, strict=True) if kind != "text"]
    values = sum(is_number(cell) or _LIST.fullmatch(cell) is not None for cell in numeric)
    return values > 0 and values + sum(cell in EMPTY for cell in numeric) > 0.5 * len(numeric)


def _labels(above: list[str], separator: str, width: int) -> tuple[str, ...]:
    """Labels of the columns from the lines above the samples; `column 1`, ... where there is no header."""
    rows: list[list[str]] = []
    for line in reversed([line for line in above if line.strip()]):
        row = _header_row(line, separator, width, bool(rows) and _is_unit_row(rows[0]))
        if row is None or len(rows) == 2:
            break
        rows.append(row)
    names = rows[0] if rows else [""] * width
    if len(rows) == 2 and _is_unit_row(rows[0]) and not _is_unit_row(rows[1]):
        units = [unit_of(_bare(cell)) for cell in rows[0]]
        names = [
            f"{name} [{unit}]" if unit is not None and split_label(name)[1] is None else name
            for name, unit in zip(rows[1], units, strict=True)
        ]
    return tuple(
        name if split_label(name)[0] else f"column {number} {name}".strip() for number, name in enumerate(names, 1)
    )


def _header_row(line: str, separator: str, width: int, numbered: bool) -> list[str] | None:
    """Cells of a line of names; None where it has another count of cells, or numbers and may not be `numbered`."""
    for row in (*_cuts(line, separator), *_cuts(_LEADING.sub("", line), separator)):
        row = row[:-1] if len(row) == width + 1 and not row[-1] else row
        row = [*row, ""] if len(row) == width - 1 and separator != BLANKS and row[0] else row
        row[:1] = [_LEADING.sub("", row[0])] if row else []
        if (
            len(row) == width
            and any(row)
            and (not any(map(is_number, row)) or (numbered and not all(map(is_number, row))))
        ):
            return row
    return None


def _cuts(line: str, separator: str) -> list[list[str]]:
    """A line cut in the ways in which headers are: as the samples, at other marks, at blanks before a name."""
    cuts = [cells_of(line, separator)]
    cuts += [cells_of(line, other) for other in SEPARATORS[:3] if other != separator and other in line]
    if separator in (BLANKS, "\t"):
        cuts += [re.split(r"\s{2,}", line.strip()), _BEFORE_A_NAME.split(line.strip())]
    return cuts


def _is_unit_row(cells: list[str]) -> bool:
    filled = [cell for cell in map(_bare, cells) if unit_of(cell) is not None]
    return bool(filled) and all(map(is_unit, filled))


def _bare(cell: str) -> str:
    return cell.strip("[](){} ")
