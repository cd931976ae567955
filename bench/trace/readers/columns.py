"""Columns of Arrow, out of a file or a data frame, as channels: numbers, or moments as times from the first of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyarrow as pa

from bench.arrays import Array
from bench.errors import InputError
from bench.trace.channel import Channel, split_label
from bench.trace.readers.moments import seconds


def channel_of(field: pa.Field, column: pa.ChunkedArray | pa.Array, path: str, start: int = 0) -> Channel:
    """Channel of a column, or of a piece of it from sample `start` on; a defect where it holds anything but numbers."""
    name, unit = split_label(field.name)
    if unit is None and field.metadata and b"unit" in field.metadata:
        unit = field.metadata[b"unit"].decode("utf-8", errors="replace")
    kind = column.type
    if is_moment(kind):
        unit = kind.unit
    channel = Channel(name, unit, np.empty(0), path, start=start)
    if (pa.types.is_string(kind) or pa.types.is_large_string(kind)) and len(column):
        texts = pa.chunked_array([column]) if isinstance(column, pa.Array) else column
        moments = seconds(texts.cast(pa.string()).fill_null(""))
        if moments is not None:
            return replace(channel, unit="s", values=moments, moments=True)
    values = _numbers(column)
    if values is None:
        return replace(channel, defect=InputError(channel.place(), f"found {kind}", "allowed: numbers"))
    return replace(channel, values=values, moments=pa.types.is_timestamp(kind))


def is_numeric(kind: pa.DataType) -> bool:
    """Whether a column holds numbers or moments; of others, texts and lists, nothing is read."""
    number = pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind)
    return number or pa.types.is_boolean(kind) or is_moment(kind)


def is_moment(kind: pa.DataType) -> bool:
    """Whether a column holds moments, read as times from the first of them."""
    return pa.types.is_timestamp(kind) or pa.types.is_duration(kind)


def _numbers(column: pa.ChunkedArray | pa.Array) -> Array | None:
    """Values as float64, nan for none, without a copy where they are float64 in one piece; None where no numbers."""
    kind = column.type
    if is_moment(kind):
        ticks = column.cast(pa.int64())
        known = ticks.drop_null()
        first = known[0].as_py() if len(known) else 0
        passed = (ticks.fill_null(first).to_numpy() - first).astype(np.float64)  # an epoch would cost the last digits
        return (
            np.where(column.is_null().to_numpy(zero_copy_only=False), np.nan, passed) if column.null_count else passed
        )
    number = pa.types.is_integer(kind) or pa.types.is_floating(kind)
    return floats(column) if number or pa.types.is_boolean(kind) or pa.types.is_decimal(kind) else None


def floats(column: pa.ChunkedArray | pa.Array) -> Array:
    """Numbers (n,), nan for none; without a copy where they are float64, all known and in one piece.

    Not by `to_numpy`, which imports pandas wherever it is installed: 0.35 s.
    """
    array = column if isinstance(column, pa.Array) else column.combine_chunks()
    array = array.chunk(0) if isinstance(array, pa.ChunkedArray) else array
    if array.null_count or not (pa.types.is_integer(array.type) or pa.types.is_floating(array.type)):
        array = array.cast(pa.float64(), safe=False).fill_null(np.nan)
    return np.from_dlpack(array).astype(np.float64, copy=False)
