"""Columns of Arrow, out of Parquet, a table, JSON or a data frame: numbers, or moments as times from the first of them.

In Parquet a unit is in the column's name, `velocity [deg/s]`, or in its field metadata under `unit`. A list of a
number for each joint is a channel for each, `q[0]`, or `q.elbow` where the file names them; a line for each joint, with
its name or number in a column, is the channels of each.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from typing import Any

import numpy as np
import pyarrow as pa

from bench.arrays import Array
from bench.bounds import require_columns, require_expansion
from bench.errors import InputError
from bench.names import short
from bench.trace.channel import Channel, Recording, split_label
from bench.trace.readers.containers import reading
from bench.trace.source import FileFormat, Source, begins

MAGIC = b"PAR1"
#: What Arrow raises on a damaged file.
DAMAGE = (pa.ArrowException, OSError, UnicodeDecodeError)
#: Bytes of a value once it is read.
WIDTH = 8
#: Fields in one another that are channels.
_DEEPEST = 16
#: Numbers of a list; a robot has fewer joints, a picture more points.
MOST_PLACES = 256

#: 2024-03-05T12:34:56.789+01:00, 05.03.2024 12:34:56,789, 12:34:56.789, 12:34:56:789, 1:34:56.7 PM, 34:56.7.
_MOMENT = (
    r"^\s*(?:(?P<date>\d{1,4}[-./]\d{1,2}[-./]\d{1,4})[T ]+)?(?:(?P<hour>\d{1,2}):)?(?P<minute>\d{1,2}):"
    r"(?P<second>\d{2})(?:[.,:](?P<fraction>\d{1,12}))?\s*(?P<half>[AaPp]\.?[Mm]\.?)?\s*"
    r"(?:Z|UTC|(?P<zone>[+-])(?P<hours>\d{2}):?(?P<minutes>\d{2}))?\s*$"
)
_PATTERN = re.compile(_MOMENT)
_DAY = 86400.0
_DATES = ("%Y-%m-%d", "%y-%m-%d", "%d-%m-%Y", "%d-%m-%y", "%m-%d-%Y", "%m-%d-%y")


def _read(source: Source) -> Recording:
    table = parquet_table(source.content, source.path)
    return Recording(tuple(channels_of_table(table, source.path)), PARQUET.format, source.path)


def parquet_table(content: bytes, path: str) -> pa.Table:
    """Columns of Parquet, those of no numbers empty; InputError where it is damaged, too large or without rows."""
    import pyarrow.parquet as pq  # 0.04 s, for one format of fifteen

    with (
        reading(path, PARQUET.format, DAMAGE),
        pq.ParquetFile(pa.BufferReader(content), page_checksum_verification=True) as file,
    ):
        fields, meta = list(file.schema_arrow), file.metadata
        require_columns(path, meta.num_columns)
        wanted = [field.name for field in fields if is_numeric(field.type)]
        # Where a column's description is damaged, asking for it ends the process: Arrow raises while it reads alone.
        plain = [field.name for field in fields if is_numeric(field.type) and not field.type.num_fields]
        for k in range(meta.num_row_groups if plain else 0):
            next(file.iter_batches(batch_size=1, row_groups=[k], columns=plain), None)
        groups = [meta.row_group(k) for k in range(meta.num_row_groups)]
        chunks = [(group.num_rows, group.column(j)) for group in groups for j in range(meta.num_columns)]
        whole = all(rows == one.num_values for rows, one in chunks if one.path_in_schema in plain)
        if not whole or sum(group.num_rows for group in groups) != meta.num_rows:  # no sum covers a description
            allowed = f"allowed: a complete {PARQUET.format} file"
            raise InputError(path, f"found columns without the {meta.num_rows} rows that its metadata states", allowed)
        read = [one for _, one in chunks if any(f"{one.path_in_schema}.".startswith(f"{name}.") for name in wanted)]
        size = sum(max(one.num_values * WIDTH, one.total_uncompressed_size) for one in read)
        require_expansion(path, size, len(content))
        if not meta.num_rows:
            raise InputError(path, "found columns and no rows", "allowed: at least two samples")
        table = file.read(None if len(wanted) == len(fields) else wanted)
    columns = iter(table.columns)
    found = [next(columns) if one.name in wanted else pa.nulls(meta.num_rows, one.type) for one in fields]
    return pa.Table.from_arrays(found, schema=pa.schema(fields))


PARQUET = FileFormat("Parquet", (".parquet", ".pq"), begins(MAGIC), _read)


def channel_of(field: pa.Field, column: pa.ChunkedArray | pa.Array, path: str, start: int = 0) -> Channel:
    """Channel of a column, or of a piece of it from sample `start` on; a defect where it has anything but numbers."""
    name, unit = split_label(field.name)
    if unit is None and field.metadata and b"unit" in field.metadata:
        unit = field.metadata[b"unit"].decode("utf-8", errors="replace")
    kind = column.type
    channel = Channel(name, kind.unit if is_moment(kind) else unit, np.empty(0), path, start=start)
    if (pa.types.is_string(kind) or pa.types.is_large_string(kind)) and len(column):
        moments = seconds(column.cast(pa.string()).fill_null(""))
        if moments is not None:
            return replace(channel, unit="s", values=moments, moments=True)
    if pa.types.is_struct(kind) or not is_numeric(kind):
        return replace(channel, defect=InputError(channel.place(), f"found {short(str(kind))}", "allowed: numbers"))
    values = _passed(column) if is_moment(kind) else floats(column)
    return replace(channel, values=values, moments=pa.types.is_timestamp(kind))


def channels_of_table(
    table: pa.Table,
    path: str,
    known: Mapping[str, Sequence[str]] | None = None,
    lists: Mapping[int, Sequence[str]] | None = None,
) -> list[Channel]:
    """Channels of columns; of lists one for each place in them, called as those of a column are `known` to be.

    A column of lists of names names those of the same length, as does `lists` by the length.
    """
    for _ in range(_DEEPEST):  # those in one another beyond it are no columns of numbers
        if any(pa.types.is_struct(kind) for kind in table.schema.types):
            table = table.flatten()  # a column for each field, `parent.field`
    require_columns(path, table.num_columns)
    named = [one for one in table.columns if pa.types.is_list(one.type) and pa.types.is_string(one.type.value_type)]
    lists = {**(lists or {}), **{len(first): first for one in named if (first := one[0].as_py())}}
    found: list[Channel] = []
    for field, column in zip(table.schema, table.columns, strict=True):
        if _is_list(field.type):
            found.extend(_places(field, _in_one(column), path, (known or {}).get(field.name), lists))
        else:
            found.append(channel_of(field, column, path))
    return found


def _is_list(kind: pa.DataType) -> bool:
    return pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind)


def _places(
    field: pa.Field, lists: pa.Array, path: str, names: Sequence[str] | None, known: Mapping[int, Sequence[str]]
) -> Iterator[Channel]:
    """A channel for each place in lists of numbers; one with a defect where they are none, or of several lengths."""
    label, unit = split_label(field.name)
    lengths = np.unique(compute().list_value_length(lists).drop_null().to_numpy(zero_copy_only=False))
    each = field.type.value_type
    plain = len(lengths) == 1 and not lists.null_count and is_numeric(each) and not each.num_fields
    if not plain or not 0 < lengths[0] <= MOST_PLACES:
        several = f"lists of {lengths[0]} to {lengths[-1]} numbers" if len(lengths) > 1 else short(str(field.type))
        channel = Channel(label, unit, np.empty(0), path)
        allowed = f"allowed: numbers, or lists of as many each, {MOST_PLACES} at most"
        yield replace(channel, defect=InputError(channel.place(), f"found {several}", allowed))
        return
    matrix = floats(lists.flatten()).reshape(-1, int(lengths[0]))
    names = names if names is not None and len(names) == lengths[0] else known.get(int(lengths[0]))
    for k, values in enumerate(matrix.T):
        name = f"{label}.{names[k]}" if names is not None else f"{label}[{k}]"
        yield Channel(name, unit, np.ascontiguousarray(values), path)


def is_numeric(kind: pa.DataType) -> bool:
    """Whether a column has numbers or moments, or lists of them; of others, texts and pictures, nothing is read."""
    if _is_list(kind):
        return is_numeric(kind.value_type)
    if pa.types.is_struct(kind):
        return any(is_numeric(kind.field(k).type) for k in range(kind.num_fields))
    number = pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind)
    return number or pa.types.is_boolean(kind) or is_moment(kind)


def is_moment(kind: pa.DataType) -> bool:
    """Whether a column has moments, read as times from the first of them."""
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

    A clock without a date that falls back by most of a day has passed midnight.
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
    ahead = 3600.0 * _number(part["hours"]) + 60.0 * _number(part["minutes"])  # of UTC
    clock = _number(part["minute"]) * 60.0 + _number(part["second"]) + _number(part["fraction"], "0.", "0")
    clock = clock + 3600.0 * hour - np.where(_words(part["zone"]) == "-", -ahead, ahead)
    dates = _words(part["date"])[known]
    if (dates != "").all():
        days = _days(dates)
        if days is None:
            return None
        clock[known] += _DAY * days
    else:
        clock[known] += _DAY * np.concatenate([[0.0], np.cumsum(np.diff(clock[known]) < -0.5 * _DAY)])
    clock[~known] = np.nan
    return clock - clock[known][0]


def _days(dates: np.ndarray) -> Array | None:
    """Days of dates (n,) from the first one; None where they are none.

    Of the orders in which all of them are dates, one without a step back is taken, and the one of the shortest span:
    03/01/2024 to 03/05/2024 are four days. Between points the day comes first.
    """
    texts, which = np.unique(dates, return_inverse=True)
    plain = [re.sub("[./]", "-", text) for text in texts.tolist()]
    found = []
    for form in _DATES[:4] if "." in dates[0] else _DATES:
        with suppress(ValueError):
            days = np.array([datetime.strptime(text, form).toordinal() for text in plain])[which]
            found.append((days - days[0]).astype(np.float64))
    return min(found, key=lambda days: ((np.diff(days) < 0).any(), np.ptp(days)), default=None)


def _number(digits: pa.Array, before: str = "0", after: str = "") -> Array:
    pc = compute()
    return pc.cast(pc.binary_join_element_wise(before, digits, after, ""), pa.float64()).to_numpy(zero_copy_only=False)


def _words(texts: pa.Array) -> np.ndarray:
    return texts.to_numpy(zero_copy_only=False).astype(str)
