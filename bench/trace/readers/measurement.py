"""Readers of measurement files in groups: MDF4 (ASAM) by asammdf, TDMS (National Instruments) by npTDMS.

Where groups hold channels of the same names, each group is an axis.

MDF: channels of a group share its master channel, the time in s; values are physical, after the file's conversions. A
conversion that is a formula is a program in a file of somebody else's, which asammdf would have evaluated: such a
channel is left out.

TDMS (LabVIEW and TwinCAT Scope write it): a channel's `unit_string` is its unit; where the waveform properties
`wf_increment` and `wf_start_offset` stand, sample k was taken at offset + k*increment, in s from `wf_start_time` (NI,
"TDMS file format internal structure").
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from typing import Any

import numpy as np

from bench.bounds import require_columns, require_expansion
from bench.errors import InputError
from bench.trace.channel import Channel, Recording, with_shared_times
from bench.trace.readers.containers import apart, library, reading, unpack, warnings_of
from bench.trace.readers.named_arrays import channels_of
from bench.trace.source import FileFormat, Source, begins

#: Conversions that are arithmetic with the file's numbers: none, linear, rational, tables; MDF 4 (the standard's
#: `cc_type`) and MDF 3 (`conversion formula identifier`, polynomials, exponentials and logarithms too).
_ARITHMETIC = {4: {0, 1, 2, 4, 5, 6}, 3: {0, 1, 2, 6, 7, 8, 9, 65535}}
_FORMULA = {4: 3, 3: 10}
#: Bytes of a value, or of its time.
_WIDTH = 8
#: Kinds of NumPy's types that are numbers or moments.
_NUMERIC = "fiubM"


def _read_mdf(source: Source) -> Recording:
    asammdf = library("asammdf", source.path, MDF.format)
    formulas: list[str] = []
    content = BytesIO(source.content)
    with (
        reading(source.path, MDF.format),
        warnings_of("asammdf"),
        asammdf.MDF(content, process_bus_logging=False) as file,
    ):
        chosen = list(_chosen(file, formulas))
        require_columns(source.path, sum(map(len, chosen)))
        _require_bounds(file, chosen, source)
        signals = [signal for channels in chosen for signal in file.select(channels, copy_master=False)]
    numeric = [
        one for one in signals if one.samples.ndim == 1 and one.samples.dtype.kind in "fiub" and one.samples.size > 1
    ]
    names = Counter(signal.name for signal in numeric)
    channels = []
    for signal in numeric:
        axis = f"group {getattr(signal, 'group_index', '')}".strip() if names[signal.name] > 1 else None
        times, values = (np.asarray(column, dtype=np.float64) for column in (signal.timestamps, signal.samples))
        time = Channel(f"{signal.name} time", "s", times, source.path, axis=axis)
        channels.append(Channel(signal.name, signal.unit or None, values, source.path, time=time, axis=axis))
    notes = tuple(f"{name} left out: its conversion is a formula, which is not evaluated" for name in formulas)
    if not channels:
        found = "; ".join(("contains no channel of numbers", *notes))
        raise InputError(source.path, found, "allowed: channels of samples")
    return Recording(with_shared_times(channels), MDF.format, source.path, notes=notes)


def _chosen(file: Any, formulas: list[str]) -> Iterator[list[tuple[None, int, int]]]:  # noqa: ANN401
    """Channels to read of each group: name, number of the group and of the channel; names of those with a formula."""
    version = 4 if file.version >= "4" else 3
    for group in file.virtual_groups:
        found = []
        for number, indices in file.included_channels(group)[group].items():
            for index in indices:
                channel = file.groups[number].channels[index]
                kind = 0 if channel.conversion is None else channel.conversion.conversion_type
                if kind in _ARITHMETIC[version]:
                    found.append((None, number, index))
                elif kind == _FORMULA[version]:
                    formulas.append(channel.name)
        if found:
            yield found


def _require_bounds(file: Any, chosen: list[list[tuple[None, int, int]]], source: Source) -> None:  # noqa: ANN401
    """InputError where the channels to read, or the blocks they lie in, grow beyond what they may."""
    size = 0
    for number, channels in Counter(number for group in chosen for _, number, _ in group).items():
        group = file.groups[number]
        stored = 0
        for block in (part for one in group.get_data_blocks() for part in (one, one.invalidation_block) if part):
            stored += block.original_size or 0
            require_expansion(source.path, size + stored, len(source.content))
            if block.block_type:  # compressed
                unpack(source.content[block.address :][: block.compressed_size], block.original_size)
        head = group.channel_group
        rows = max(head.cycles_nr, stored // max(head.samples_byte_nr, 1))
        size += stored + rows * (channels + 1) * _WIDTH
        require_expansion(source.path, size, len(source.content))


def _read_tdms(source: Source) -> Recording:
    nptdms = library("nptdms", source.path, TDMS.format)
    content = BytesIO(source.content)
    with (
        reading(source.path, TDMS.format),
        warnings_of("nptdms") as warnings,
        nptdms.TdmsFile.open(content) as file,
    ):
        numeric = [
            (group.name, channel)
            for group in file.groups()
            for channel in group.channels()
            if channel.dtype is not None and np.dtype(channel.dtype).kind in _NUMERIC  # texts are not read
        ]
        require_columns(source.path, len(numeric))
        require_expansion(source.path, sum(len(channel) for _, channel in numeric) * _WIDTH, len(source.content))
        read = [(group, channel, channel[:]) for group, channel in numeric]
        metadata = {str(name): str(value) for name, value in file.properties.items()}
    names = Counter(channel.name for _, channel in numeric)
    starts = [channel.properties.get("wf_start_time") for _, channel in numeric]
    first = min((start for start in starts if start is not None), default=None)
    channels = [
        _tdms_channel(channel, values, group if max(names.values()) > 1 else None, first, source.path)
        for group, channel, values in read
        if isinstance(values, np.ndarray) and values.dtype.kind in _NUMERIC and values.ndim == 1 and values.size > 1
    ]
    if not channels:
        raise InputError(source.path, "contains no channel of numbers", "allowed: channels of samples")
    return Recording(with_shared_times(channels), TDMS.format, source.path, metadata, notes=tuple(warnings))


def _tdms_channel(channel: Any, values: np.ndarray, axis: str | None, first: Any, path: str) -> Channel:  # noqa: ANN401
    properties = channel.properties
    increment = properties.get("wf_increment")
    time = None
    if increment:
        start = properties.get("wf_start_time")
        late = float((start - first) / np.timedelta64(1, "ns")) * 1e-9 if start is not None else 0.0
        begin = late + float(properties.get("wf_start_offset", 0.0))
        times = np.asarray(begin + float(increment) * np.arange(values.size), dtype=np.float64)
        time = Channel(f"{channel.name} time", "s", times, path, axis=axis)
    plain = next(channels_of(channel.name, values, path, str(properties.get("unit_string", "")) or None))
    return replace(plain, time=time, axis=axis)


#: A bit that has flipped among what describes a channel ends asammdf's compiled part: 1 of 40 files.
MDF = FileFormat("MDF4", (".mf4", ".mdf"), begins(b"MDF     ", b"UnFinMF "), apart(_read_mdf))
TDMS = FileFormat("TDMS", (".tdms",), begins(b"TDSm"), _read_tdms)
