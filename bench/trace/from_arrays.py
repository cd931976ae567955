"""Samples in memory, arrays or a data frame, as a recording: columns as a reader returns them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import InputError
from bench.trace.channel import ARRAYS, Channel, Recording, split_label, with_units
from bench.trace.choose import GivenOptions
from bench.trace.signals import signal_of
from bench.units import parse

if TYPE_CHECKING:
    import pyarrow as pa

#: Name that Arrow gives an index of pandas without one.
_INDEX = "__index_level_0__"


class ArrowStream(Protocol):
    """A data frame that hands out its columns by Arrow's protocol, as pandas, polars and Arrow itself do."""

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """Columns as a stream of Arrow arrays."""
        ...


Arrays = Mapping[str, ArrayLike] | ArrowStream


def recording_of(signals: Arrays, origin: str = ARRAYS) -> Recording:
    """Columns of arrays by their names, of a structured array or of a data frame, as a reader returns them."""
    return Recording(with_units(tuple(_channels(signals, origin))), ARRAYS, origin)


def options_of(recording: Recording, sample_period: float | str | None, columns: Mapping[str, str]) -> GivenOptions:
    """How `Trace.from_arrays` reads a recording, whose arguments these are."""
    origin = recording.origin
    timed = "time" in columns or any(signal_of(channel.name) == "time" for channel in recording.channels)
    if timed == (sample_period is not None):
        found = "found a column of it and a sample_period" if timed else "found no column of it and no sample_period"
        raise InputError(f"{origin}: time", found, "allowed: one of them")
    if sample_period is None:
        return GivenOptions(columns)
    where = f"{origin}: sample_period"
    period = parse(sample_period, "s", where) if isinstance(sample_period, str) else float(sample_period)
    if not (math.isfinite(period) and period > 0.0):
        raise InputError(where, f"found {sample_period}", "allowed: a positive time, in s where no unit is stated")
    return GivenOptions(columns, period)


def _channels(signals: Arrays, origin: str) -> Iterator[Channel]:
    """Columns with copies of the samples, independent of the caller's arrays."""
    if isinstance(signals, np.ndarray) and signals.dtype.names:
        signals = {name: signals[name] for name in signals.dtype.names}
    if isinstance(signals, Mapping):
        found = (_channel(label, values, origin) for label, values in signals.items())
    else:
        import pyarrow as pa  # 0.05 s

        from bench.trace.readers.arrow import channel_of

        try:
            table = _index_named(pa.table(signals))
        except TypeError as error:
            allowed = "allowed: arrays by their names, or a data frame"
            raise InputError(origin, f"found {type(signals).__name__}", allowed) from error
        except pa.ArrowException as error:
            said = f"the data frame cannot be read ({' '.join(str(error).split())})"
            raise InputError(origin, said, "allowed: columns of one type each; drop the others") from error
        found = (channel_of(*column, origin) for column in zip(table.schema, table.columns, strict=True))
    return (replace(channel, values=channel.values.copy()) for channel in found)


def _index_named(table: pa.Table) -> pa.Table:
    """The table with the index of pandas as its time, where that has no name, no whole numbers and is the only one."""
    import pyarrow as pa

    names = table.column_names
    if _INDEX not in names or "time" in names or pa.types.is_integer(table.schema.field(_INDEX).type):
        return table
    return table.rename_columns(["time" if name == _INDEX else name for name in names])


def _channel(label: str, values: ArrayLike, origin: str) -> Channel:
    """Channel of one array; a defect where it has anything but a number for each sample."""
    import pyarrow as pa

    from bench.trace.readers.arrow import channel_of

    channel = Channel(*split_label(label), np.empty(0), origin)
    try:
        array = np.asarray(values)
        if array.ndim == 1:
            column = pa.array(array)
            return channel_of(pa.field(label, column.type), column, origin)
        found = f"shape {array.shape}"
    except (ValueError, pa.ArrowException):  # rows of different lengths; objects that Arrow has no type for
        found = "what is no number"
    return replace(channel, defect=InputError(channel.place(), f"found {found}", "allowed: one number a sample"))
