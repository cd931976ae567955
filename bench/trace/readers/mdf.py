"""Reader of MDF4 (ASAM; measurement of vehicles and test benches), by asammdf.

Channels of a group share its master channel, the time in s; values are physical, after the file's conversions.
"""

from __future__ import annotations

from collections import Counter
from io import BytesIO

import numpy as np

from bench.errors import InputError
from bench.trace.channel import Channel, Recording, with_shared_times
from bench.trace.readers.extras import damaged, library
from bench.trace.source import Source

FORMAT = "MDF4"
ENDINGS = (".mf4", ".mdf")

_MAGIC = b"MDF     "


def recognises(source: Source) -> bool:
    """Whether the file begins as MDF does."""
    return source.content.startswith((_MAGIC, b"UnFinMF "))


def read(source: Source) -> Recording:
    """Recording of an MDF file; where groups hold channels of the same names, each group is an axis.

    Raises:
        InputError: asammdf is not installed; damaged, or without a channel of numbers.
    """
    asammdf = library("asammdf", "asammdf", "mdf", source.path, FORMAT)
    try:
        with asammdf.MDF(BytesIO(source.content)) as file:
            signals = list(file.iter_channels(skip_master=True, copy_master=True))
    except Exception as error:  # asammdf raises many kinds on a damaged file
        raise damaged(source.path, FORMAT, error) from error
    numeric = [
        one for one in signals if one.samples.ndim == 1 and one.samples.dtype.kind in "fiub" and one.samples.size > 1
    ]
    names = Counter(signal.name for signal in numeric)
    channels = []
    for signal in numeric:
        axis = (_group(signal) or None) if names[signal.name] > 1 else None
        time = Channel(
            f"{signal.name} time", "s", np.asarray(signal.timestamps, dtype=np.float64), source.path, axis=axis
        )
        values = np.asarray(signal.samples, dtype=np.float64)
        channels.append(Channel(signal.name, signal.unit or None, values, source.path, time=time, axis=axis))
    if not channels:
        raise InputError(source.path, "holds no channel of numbers", "allowed: channels of samples")
    return Recording(with_shared_times(channels), FORMAT, source.path)


def _group(signal: object) -> str:
    return f"group {getattr(signal, 'group_index', '')}".strip()
