"""Reader of TDMS (National Instruments; LabVIEW and TwinCAT Scope write it), by npTDMS.

A channel's `unit_string` is its unit; where the waveform properties `wf_increment` and `wf_start_offset` stand, sample
k was taken at offset + k*increment, in s from `wf_start_time` (NI, "TDMS file format internal structure").
"""

from __future__ import annotations

from collections import Counter
from io import BytesIO
from typing import Any

import numpy as np

from bench.bounds import require_expansion
from bench.errors import InputError
from bench.trace.channel import Channel, Recording, with_shared_times
from bench.trace.readers.containers import channels_of, library, reading, warnings_of
from bench.trace.source import Source

_MAGIC = b"TDSm"
#: Kinds of NumPy's types that are numbers or moments, and bytes of a value.
_NUMERIC, _WIDTH = "fiubM", 8


class Tdms:
    """TDMS, see the module."""

    format = "TDMS"
    endings = (".tdms",)

    def recognises(self, source: Source) -> bool:
        """Whether the file begins as a segment of TDMS does."""
        return source.content.startswith(_MAGIC)

    def read(self, source: Source) -> Recording:
        """Recording of a TDMS file; where groups hold channels of the same names, each group is an axis.

        Raises:
            InputError: npTDMS is not installed; damaged, beyond the bounds, or without a channel of numbers.
        """
        nptdms = library("nptdms", "npTDMS", "tdms", source.path, self.format)
        content = BytesIO(source.content)
        with (
            reading(source.path, self.format),
            warnings_of("nptdms") as warnings,
            nptdms.TdmsFile.open(content) as file,
        ):
            numeric = {group.name: [one for one in group.channels() if _numeric(one)] for group in file.groups()}
            size = sum(len(channel) for channels in numeric.values() for channel in channels) * _WIDTH
            require_expansion(source.path, size, len(source.content))
            groups = {name: [(channel, channel[:]) for channel in channels] for name, channels in numeric.items()}
            metadata = {str(name): str(value) for name, value in file.properties.items()}
        names = Counter(channel.name for channels in groups.values() for channel, _ in channels)
        alike = any(count > 1 for count in names.values())
        starts = [channel.properties.get("wf_start_time") for channels in groups.values() for channel, _ in channels]
        first = min((start for start in starts if start is not None), default=None)
        found = [
            _channel(channel, values, group if alike else None, first, source.path)
            for group, channels in groups.items()
            for channel, values in channels
            if isinstance(values, np.ndarray) and values.dtype.kind in _NUMERIC and values.ndim == 1 and values.size > 1
        ]
        if not found:
            raise InputError(source.path, "holds no channel of numbers", "allowed: channels of samples")
        timed = iter(with_shared_times([channel for channel in found if channel.time is not None]))
        channels = tuple(next(timed) if channel.time is not None else channel for channel in found)
        return Recording(channels, self.format, source.path, metadata, notes=tuple(warnings))


def _numeric(channel: Any) -> bool:  # noqa: ANN401
    """Whether a channel holds numbers or moments; texts are not read."""
    return channel.dtype is not None and np.dtype(channel.dtype).kind in _NUMERIC


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
