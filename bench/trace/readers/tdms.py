"""Reader of TDMS (National Instruments; LabVIEW and TwinCAT Scope write it), by npTDMS.

A channel's `unit_string` is its unit; where the waveform properties `wf_increment` and `wf_start_offset` stand, sample
k was taken at offset + k*increment, in s from `wf_start_time` (NI, "TDMS file format internal structure").
"""

from __future__ import annotations

from collections import Counter
from io import BytesIO
from typing import Any

import numpy as np

from bench.errors import InputError
from bench.trace.channel import Channel, Recording, with_shared_times
from bench.trace.readers.arrays import channels_of
from bench.trace.readers.extras import damaged, library
from bench.trace.source import Source

FORMAT = "TDMS"
ENDINGS = (".tdms",)

_MAGIC = b"TDSm"


def recognises(source: Source) -> bool:
    """Whether the file begins as a segment of TDMS does."""
    return source.content.startswith(_MAGIC)


def read(source: Source) -> Recording:
    """Recording of a TDMS file; where groups hold channels of the same names, each group is an axis.

    Raises:
        InputError: npTDMS is not installed; damaged, or without a channel of numbers.
    """
    nptdms = library("nptdms", "npTDMS", "tdms", source.path, FORMAT)
    try:
        with nptdms.TdmsFile.open(BytesIO(source.content)) as file:
            groups = {group.name: [(channel, channel[:]) for channel in group.channels()] for group in file.groups()}
            metadata = {str(name): str(value) for name, value in file.properties.items()}
    except Exception as error:  # npTDMS raises many kinds on a damaged file
        raise damaged(source.path, FORMAT, error) from error
    names = Counter(channel.name for channels in groups.values() for channel, _ in channels)
    alike = any(count > 1 for count in names.values())
    starts = [channel.properties.get("wf_start_time") for channels in groups.values() for channel, _ in channels]
    first = min((start for start in starts if start is not None), default=None)
    found = [
        _channel(channel, values, group if alike else None, first, source.path)
        for group, channels in groups.items()
        for channel, values in channels
        if isinstance(values, np.ndarray) and values.dtype.kind in "fiubM" and values.ndim == 1 and values.size > 1
    ]
    if not found:
        raise InputError(source.path, "holds no channel of numbers", "allowed: channels of samples")
    timed = iter(with_shared_times([channel for channel in found if channel.time is not None]))
    channels = tuple(next(timed) if channel.time is not None else channel for channel in found)
    return Recording(channels, FORMAT, source.path, metadata)


def _channel(channel: Any, values: np.ndarray, axis: str | None, first: Any, path: str) -> Channel:  # noqa: ANN401
    properties = channel.properties
    plain = next(channels_of(channel.name, values, path, str(properties.get("unit_string", "")) or None))
    increment = properties.get("wf_increment")
    time = None
    if increment:
        start = properties.get("wf_start_time")
        late = float((start - first) / np.timedelta64(1, "ns")) * 1e-9 if start is not None else 0.0
        begin = late + float(properties.get("wf_start_offset", 0.0))
        times = np.asarray(begin + float(increment) * np.arange(values.size), dtype=np.float64)
        time = Channel(f"{channel.name} time", "s", times, path, axis=axis)
    return Channel(plain.name, plain.unit, plain.values, path, time=time, axis=axis, moments=plain.moments)
