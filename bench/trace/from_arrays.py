"""Samples in memory, arrays or a data frame, as a recording: columns as a reader returns them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from bench.errors import InputError
from bench.names import nearest
from bench.trace.channel import Channel, Recording, split_label, with_units
from bench.trace.readers.arrow import channel_of
from bench.trace.signals import SI_UNITS, signal_of
from bench.units import parse

FORMAT = "arrays"


class ArrowStream(Protocol):
    """A data frame that hands out its columns by Arrow's protocol, as pandas, polars and Arrow itself do."""

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """Columns as a stream of Arrow arrays."""
        ...


Arrays = Mapping[str, ArrayLike] | ArrowStream


def recording_of(
    signals: Arrays,
    units: Mapping[str, str],
    sample_period: float | str | None,
    columns: Mapping[str, str],
    origin: str,
) -> Recording:
    """Columns of `Trace.from_arrays`, whose arguments these are."""
    channels = list(with_units(tuple(_channels(signals, origin))))
    names = [channel.name for channel in channels]
    for name in units:
        if name not in names:
            found = f"no such column{nearest(name, names)}"
            raise InputError(f"{origin}: unit of {name}", found, f"found: {', '.join(names)}")
    channels = [replace(channel, unit=units.get(channel.name, channel.unit)) for channel in channels]
    _require_units(channels, columns)
    timed = "time" in columns or any(signal_of(name) == "time" for name in names)
    if timed == (sample_period is not None):
        found = "found a column of it and a sample_period" if timed else "found no column of it and no sample_period"
        raise InputError(f"{origin}: time", found, "allowed: one of them")
    if sample_period is not None:
        where = f"{origin}: sample_period"
        period = parse(sample_period, "s", where) if isinstance(sample_period, str) else float(sample_period)
        if not (math.isfinite(period) and period > 0.0):
            allowed = "allowed: a positive time, in s where no unit is stated"
            raise InputError(where, f"found {sample_period}", allowed)
        samples = max((channel.values.size for channel in channels), default=0)
        channels.append(Channel("time", "s", np.arange(samples, dtype=np.float64) * period, origin))
    return Recording(tuple(channels), FORMAT, origin)


def _channels(signals: Arrays, origin: str) -> Iterator[Channel]:
    """Columns with copies of the samples, independent of the caller's arrays."""
    if isinstance(signals, Mapping):
        found = (_channel(label, values, origin) for label, values in signals.items())
    else:
        try:
            table = pa.table(signals)
        except TypeError as error:
            allowed = "allowed: arrays by their names, or a data frame"
            raise InputError(origin, f"found {type(signals).__name__}", allowed) from error
        except pa.ArrowException as error:
            said = f"the data frame cannot be read ({' '.join(str(error).split())})"
            raise InputError(origin, said, "allowed: columns of one type each; drop the others") from error
        found = (channel_of(*column, origin) for column in zip(table.schema, table.columns, strict=True))
    return (replace(channel, values=channel.values.copy()) for channel in found)


def _channel(label: str, values: ArrayLike, origin: str) -> Channel:
    """Channel of one array; a defect where it holds anything but a number for each sample."""
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


def _require_units(channels: Sequence[Channel], columns: Mapping[str, str]) -> None:
    """InputError naming the first signal of no unit, neither in its column's name nor stated."""
    names = {channel.name for channel in channels}
    for channel in channels:
        signal = signal_of(channel.name)
        if signal is None or channel.unit is not None or signal in columns:
            continue
        if signal == channel.name or signal not in names:
            usual = "s" if signal == "time" else SI_UNITS[signal][0]
            allowed = f'allowed: units={{"{channel.name}": "{usual}"}} or another unit of it'
            raise InputError(f"{channel.origin}: {channel.name}", "has no unit", allowed)
