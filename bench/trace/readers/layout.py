"""How a table in text is laid out: separator, decimal mark, header, units, and where its samples begin.

The samples tell: of the separators, the one that cuts the most numbers out of the last lines of the head. The first
line that is like them begins the samples; above it stand, in this order and each if at all, a preamble, the header and
a row of units.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from dataclasses import dataclass

from bench.trace.channel import split_label
from bench.trace.readers.moments import is_moment
from bench.trace.signals import signal_of, unit_of
from bench.units.text import UnitError, is_unit, scale_of

BLANKS = " "
SEPARATORS = ("\t", ";", ",", BLANKS)
#: Texts that stand for no number.
EMPTY = (
    *("", " ", "-", "--", "---", "?", "*", "null", "NULL", "None", "NA", "N/A", "#N/A", "n/a"),
    *("nan", "NaN", "NAN", "Nan", "-nan", "-NaN", "nan(ind)", "-nan(ind)", "1.#QNAN"),
)
#: Characters of the head that are looked at, and lines at its end that show what samples are like.
HEAD, SHOWN = 1 << 18, 60

_NUMBER = re.compile(r"[+-]?(?:\d[\d.,'’\u00a0\u202f]*|[.,]\d+)(?:[eE][+-]?\d+)?")
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?|[+-]?\d{1,3}(?:[.'’\u00a0\u202f]\d{3})+,\d*")
_WORDS = frozenset(("true", "false", "inf", "-inf", "+inf", "infinity", "-infinity"))
_LEADING = re.compile(r"^\s*(?:#+|//+|!+|%+(?=\s))\s*")
_EXACT = re.compile(r"[+-]?\d{16,}|[+-]?\d{9,}[.,]\d{4,9}")


@dataclass(frozen=True)
class TableLayout:
    """How a table is written.

    Attributes:
        labels: of the columns, with their units.
        separator, decimal: characters between columns and in numbers; BLANKS: any run of them.
        start: line of the first samples, counted from 0.
        kinds: of each column: `number`, `exact` (instants of more digits than a float holds), `text`.
    """

    labels: tuple[str, ...]
    separator: str
    decimal: str
    start: int
    kinds: tuple[str, ...]

    @property
    def delimiter(self) -> str:
        """The one character between columns, once runs of blanks are tabs."""
        return "\t" if self.separator == BLANKS else self.separator


def layout_of(labels: tuple[str, ...], separator: str, decimal: str = ".") -> TableLayout:
    """Layout of lines of numbers under a header that tells all of it."""
    return TableLayout(labels, separator, decimal, 0, ("number",) * len(labels))


def cells_of(line: str, separator: str) -> list[str]:
    """Cells of a line, without quotes."""
    text = " ".join(line.split()) if separator == BLANKS else line.replace("\r", "")
    try:
        row = next(csv.reader([text], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:  # longer than any cell of a recording
        return []
    return [cell.strip() for cell in row]


def is_number(cell: str) -> bool:
    """Whether a cell holds a number in any of the usual ways of writing one."""
    return _NUMBER.fullmatch(cell) is not None or cell.lower() in _WORDS


def _is_value(cell: str) -> bool:
    return cell in EMPTY or is_number(cell) or is_moment(cell)


def find_layout(lines: list[str]) -> TableLayout | None:
    """The layout of a table that begins with these lines; None where they show none."""
    shown = [line for line in lines if line.strip()][-SHOWN:]
    separator, width = _separator(shown)
    if not width:
        return None
    rows = [row for row in (cells_of(line, separator) for line in shown) if len(row) == width]
    columns = list(zip(*rows, strict=True))
    kinds = tuple(_kind(column) for column in columns)
    start = next((number for number in range(len(lines)) if _begins(lines, number, separator, kinds)), None)
    if start is None or ("number" not in kinds and "exact" not in kinds):
        return None
    decimal = "," if any(_DECIMAL_COMMA.fullmatch(cell) for row in rows for cell in row) else "."
    labels = _labels(lines[:start], separator, width)
    exact = (kind != "exact" or _may_be_time(label) for kind, label in zip(kinds, labels, strict=True))
    kinds = tuple(kind if kept else "number" for kind, kept in zip(kinds, exact, strict=True))
    return TableLayout(labels, separator, decimal, start, kinds)


def _may_be_time(label: str) -> bool:
    """Whether a column may hold instants, of which only the distances count: not one of a signal or another unit."""
    name, unit = split_label(label)
    if signal_of(name) not in (None, "time"):
        return False
    try:
        return unit_of(unit) is None or scale_of(str(unit), ("s",)) is not None
    except UnitError:
        return False


def _separator(shown: list[str]) -> tuple[str, int]:
    """Separator that cuts out the most numbers, and how many cells it makes; 0 where none makes two."""
    best, found = 0.0, (",", 0)
    for separator in SEPARATORS:
        rows = [cells_of(line, separator) for line in shown]
        counts = Counter(len(row) for row in rows)
        if not counts:
            continue
        width, often = counts.most_common(1)[0]
        if width < 2 or often < 0.5 * len(rows):
            continue
        cells = [cell for row in rows if len(row) == width for cell in row]
        values = sum(_is_value(cell) for cell in cells)
        score = values / often * values / len(cells) * often / len(rows)
        if score > best:
            best, found = score, (separator, width)
    return found


def _kind(cells: tuple[str, ...]) -> str:
    filled = [cell for cell in cells if cell not in EMPTY]
    if filled and sum(is_number(cell) for cell in filled) < 0.5 * len(filled):
        return "text"
    return "exact" if filled and all(_EXACT.fullmatch(cell) for cell in filled) else "number"


def _begins(lines: list[str], number: int, separator: str, kinds: tuple[str, ...]) -> bool:
    """Whether a line and the next ones are samples."""
    ahead = [line for line in lines[number : number + 8] if line.strip()][:2]
    return bool(lines[number].strip()) and all(_is_sample(line, separator, kinds) for line in ahead)


def _is_sample(line: str, separator: str, kinds: tuple[str, ...]) -> bool:
    cells = cells_of(line, separator)
    if len(cells) != len(kinds):
        return False
    numeric = [cell for cell, kind in zip(cells, kinds, strict=True) if kind != "text"]
    numbers = sum(cell in EMPTY or is_number(cell) for cell in numeric)
    return numbers > 0.5 * len(numeric) and any(is_number(cell) for cell in numeric)


def _labels(above: list[str], separator: str, width: int) -> tuple[str, ...]:
    """Labels of the columns from the lines above the samples; `column 1`, ... where there is no header."""
    rows: list[list[str]] = []
    for line in reversed(above):
        if line.strip():
            row = _header_row(line, separator, width)
            if row is None or len(rows) == 2:
                break
            rows.append(row)
    names = rows[0] if rows else [""] * width
    if len(rows) == 2 and _is_unit_row(rows[0]) and not _is_unit_row(rows[1]):
        units = [cell.strip("[](){} ") for cell in rows[0]]
        names = [_with_unit(name, unit) for name, unit in zip(rows[1], units, strict=True)]
    return tuple(
        name if split_label(name)[0] else f"column {number} {name}".strip() for number, name in enumerate(names, 1)
    )


def _with_unit(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit_of(unit) is not None and split_label(name)[1] is None else name


def _header_row(line: str, separator: str, width: int) -> list[str] | None:
    """Cells of a line of names; None where it is none: another count of cells, or numbers among them."""
    for text in (line, _LEADING.sub("", line)):
        for row in _cuts(text, separator):
            row = row[:-1] if len(row) == width + 1 and not row[-1] else row
            row = [*row, ""] if len(row) == width - 1 and separator != BLANKS and row[0] else row
            row[:1] = [_LEADING.sub("", row[0])] if row else []
            if len(row) == width and any(row) and not any(is_number(cell) for cell in row):
                return row
    return None


def _cuts(line: str, separator: str) -> list[list[str]]:
    """A line cut in the ways in which headers are: as the samples, at other marks, at blanks before no bracket."""
    cuts = [cells_of(line, separator)]
    cuts += [cells_of(line, other) for other in SEPARATORS[:3] if other != separator and other in line]
    if separator == BLANKS or separator == "\t":
        cuts += [re.split(r"\s{2,}", line.strip()), re.split(r"\s+(?![\[(])", line.strip())]
    return cuts


def _is_unit_row(cells: list[str]) -> bool:
    filled = [cell.strip("[](){} ") for cell in cells]
    filled = [cell for cell in filled if unit_of(cell) is not None]
    return bool(filled) and all(is_unit(cell) for cell in filled)
