"""Columns of Arrow, out of Parquet, a table or a data frame: numbers, or moments as times from the first of them.

In Parquet a unit stands in the column's name, `velocity [deg/s]`, or in its field metadata under `unit`.
"""

from __future__ import annotations

import importlib
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa

from bench.arrays import Array
from bench.bounds import require_expansion
from bench.errors import InputError
from bench.trace.channel import Channel, Recording, split_label
from bench.trace.readers.containers import reading
from bench.trace.source import FileFormat, Source, begins

MAGIC = b"PAR1"
#: What Arrow raises on a damaged file.
DAMAGE = (pa.ArrowException, OSError, UnicodeDecodeError)
#: Bytes of a value once it is read.
WIDTH = 8

#: 2024-03-05T12:34:56.789+01:00, 05.03.2024 12:34:56,789, 12:34:56.789, 12:34:56:789, 1:34:56.7 PM, 34:56.7.
_MOMENT = (
    r"^\s*(?:(?P<date>\d{1,4}[-./]\d{1,2}[-./]\d{1,4})[T ]+)?(?:(?P<hour>\d{1,2}):)?(?P<minute>\d{1,2}):"
    r"(?P<second>\d{2})(?:[.,:](?P<fraction>\d{1,12}))?\s*(?P<half>[AaPp]\.?[Mm]\.?)?\s*"
    r"(?P<zone>Z|UTC|[+-]\d{2}:?\d{2})?\s*$"
)
_PATTERN = re.compile(_MOMENT)
_DAY = 86400.0


def _read(source: Source) -> Recording:
    import pyarrow.parquet as pq  # 0.04 s, for one format of fifteen

    with reading(source.path, PARQUET.format, DAMAGE), pq.ParquetFile(pa.BufferReader(source.content)) as file:
        fields = list(file.schema_arrow)
        wanted = [field.name for field in fields if is_numeric(field.type)]
        rows = file.metadata.num_rows
        require_expansion(source.path, rows * len(wanted) * WIDTH, len(source.content))
        table = file.read(None if len(wanted) == len(fields) else wanted)
    if not rows:
        raise InputError(source.path, "found columns and no rows", "allowed: at least two samples")
    columns = iter(table.columns)
    channels = tuple(
        channel_of(field, next(columns) if is_numeric(field.type) else pa.nulls(0, field.type), source.path)
        for field in fields
    )
    return Recording(channels, PARQUET.format, source.path)


PARQUET = FileFormat("Parquet", (".parquet", ".pq"), begins(MAGIC), _read)


def channel_of(field: pa.Field, column: pa.ChunkedArray | pa.Array, path: str, start: int = 0) -> Channel:
    """Channel of a column, or of a piece of it from sample `start` on; a defect where it holds anything but numbers."""
    name, unit = split_label(field.name)
    if unit is None and field.metadata and b"unit" in field.metadata:
        unit = field.metadata[b"unit"].decode("utf-8", errors="replace")
    kind = column.type
    channel = Channel(name, kind.unit if is_moment(kind) else unit, np.empty(0), path, start=start)
    if (pa.types.is_string(kind) or pa.types.is_large_string(kind)) and len(column):
        moments = seconds(column.cast(pa.string()).fill_null(""))
        if moments is not None:
            return replace(channel, unit="s", values=moments, moments=True)
    if not is_numeric(kind):
        return replace(channel, defect=InputError(channel.place(), f"found {kind}", "allowed: numbers"))
    values = _passed(column) if is_moment(kind) else floats(column)
    return replace(channel, values=values, moments=pa.types.is_timestamp(kind))


def is_numeric(kind: pa.DataType) -> bool:
    """Whether a column holds numbers or moments; of others, texts and lists, nothing is read."""
    number = pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind)
    return number or pa.types.is_boolean(kind) or is_moment(kind)


def is_moment(kind: pa.DataType) -> bool:
    """Whether a column holds moments, read as times from the first of them."""
    return pa.types.is_timestamp(kind) or pa.types.is_duration(kind)


def _passed(column: pa.ChunkedArray | pa.Array) -> Array:
    """Moments (n,) less the first that is known, in their unit, nan for none: an epoch would cost the last digits."""
    ticks = column.cast(pa.int64())
    known = ticks.drop_null()
    first = known[0].as_py() if len(known) else 0
    passed = (ticks.fill_null(first).to_numpy() - first).astype(np.float64)
    return np.where(column.is_null().to_numpy(zero_copy_only=False), np.nan, passed) if column.null_count else passed


def floats(column: pa.ChunkedArray | pa.Array) -> Array:
    """Numbers (n,), nan for none; without a copy where they are float64, all known and in one piece.

    Not by `to_numpy`, which imports pandas wherever it is installed: 0.35 s.
    """
    array = _in_one(column)
    if array.null_count or not (pa.types.is_integer(array.type) or pa.types.is_floating(array.type)):
        array = array.cast(pa.float64(), safe=False).fill_null(np.nan)
    return np.from_dlpack(array).astype(np.float64, copy=False)


def _in_one(column: pa.ChunkedArray | pa.Array) -> pa.Array:
    array = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    return array.chunk(0) if isinstance(array, pa.ChunkedArray) else array


def compute() -> Any:  # noqa: ANN401
    """Arrow's functions, which take 0.05 s to import and are made then, so that checkers of types know none."""
    return importlib.import_module("pyarrow.compute")


def speaks_of_moment(text: str) -> bool:
    """Whether a text is a time of a clock or a calendar."""
    return _PATTERN.match(text) is not None


def seconds(texts: pa.ChunkedArray | pa.Array) -> Array | None:
    """Seconds from the first moment - (n,), nan where a cell is empty; None where one is no moment.

    Dates are told apart, not read: they count days in the order in which they appear, so that it does not matter which
    of their numbers is the month. A clock without a date that falls back by most of a day has passed midnight.
    """
    pc = compute()
    column = _in_one(texts)
    parts = pc.extract_regex(column, pattern=_MOMENT)
    known = ~pc.equal(pc.utf8_trim_whitespace(column), "").to_numpy(zero_copy_only=False).astype(bool)
    if (parts.is_null().to_numpy(zero_copy_only=False) & known).any() or not known.any():
        return None
    part = {name: pc.struct_field(parts, name).fill_null("") for name in _PATTERN.groupindex}
    hour, half = _number(part["hour"]), np.char.upper(_words(part["half"]))
    hour = np.where(half == "", hour, hour % 12 + 12 * np.char.startswith(half, "P"))
    names, which = np.unique(_words(part["zone"]), return_inverse=True)
    ahead = np.array([_ahead(name) for name in names])[which]
    clock = _number(part["minute"]) * 60.0 + _number(part["second"]) + _number(part["fraction"], "0.", "0")
    clock = clock + 3600.0 * hour - ahead
    dates = _words(part["date"])[known]
    if (dates != "").all():
        _, first, which = np.unique(dates, return_index=True, return_inverse=True)
        clock[known] += _DAY * np.argsort(np.argsort(first))[which]
    else:
        clock[known] += _DAY * np.concatenate([[0.0], np.cumsum(np.diff(clock[known]) < -0.5 * _DAY)])
    clock[~known] = np.nan
    return clock - clock[known][0]


def _number(digits: pa.Array, before: str = "0", after: str = "") -> Array:
    pc = compute()
    return pc.cast(pc.binary_join_element_wise(before, digits, after, ""), pa.float64()).to_numpy(zero_copy_only=False)


def _words(texts: pa.Array) -> np.ndarray:
    return texts.to_numpy(zero_copy_only=False).astype(str)


def _ahead(zone: str) -> float:
    """Seconds by which the clock of a time zone is ahead of UTC."""
    digits = zone.replace(":", "")
    return float(f"{digits[0]}1") * (3600 * int(digits[1:3]) + 60 * int(digits[3:5])) if zone[:1] in ("+", "-") else 0.0
