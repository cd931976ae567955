"""Reader of MDF4 (ASAM; measurement of vehicles and test benches), by asammdf.

Channels of a group share its master channel, the time in s; values are physical, after the file's conversions. A
conversion that is a formula is a program in a file of somebody else's, which asammdf would have evaluated: such a
channel is left out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from io import BytesIO
from typing import Any

import numpy as np

from bench.bounds import require_expansion
from bench.errors import InputError
from bench.trace.channel import Channel, Recording, with_shared_times
from bench.trace.readers.containers import library, reading, unpack, warnings_of
from bench.trace.source import Source

_MAGIC = b"MDF     "
#: Conversions that are arithmetic with the file's numbers: none, linear, rational, tables; MDF 4 (the standard's
#: `cc_type`) and MDF 3 (`conversion formula identifier`, polynomials, exponentials and logarithms too).
_ARITHMETIC = {4: {0, 1, 2, 4, 5, 6}, 3: {0, 1, 2, 6, 7, 8, 9, 65535}}
_FORMULA = {4: 3, 3: 10}
#: Bytes of a value, and of its time.
_WIDTH = 8


class Mdf:
    """MDF4, see the module."""

    format = "MDF4"
    endings = (".mf4", ".mdf")

    def recognises(self, source: Source) -> bool:
        """Whether the file begins as MDF does."""
        return source.content.startswith((_MAGIC, b"UnFinMF "))

    def read(self, source: Source) -> Recording:
        """Recording of an MDF file; where groups hold channels of the same names, each group is an axis.

        Raises:
            InputError: asammdf is not installed; damaged, beyond the bounds, or without a channel of numbers.
        """
        asammdf = library("asammdf", "asammdf", "mdf", source.path, self.format)
        formulas: list[str] = []
        content = BytesIO(source.content)
        with (
            reading(source.path, self.format),
            warnings_of("asammdf"),
            asammdf.MDF(content, process_bus_logging=False) as file,
        ):
            chosen = list(_chosen(file, formulas))
            _require_bounds(file, chosen, source)
            signals = [signal for channels in chosen for signal in file.select(channels, copy_master=False)]
        numeric = [
            one
            for one in signals
            if one.samples.ndim == 1 and one.samples.dtype.kind in "fiub" and one.samples.size > 1
        ]
        names = Counter(signal.name for signal in numeric)
        channels = []
        for signal in numeric:
            axis = f"group {getattr(signal, 'group_index', '')}".strip() if names[signal.name] > 1 else None
            time = Channel(
                f"{signal.name} time", "s", np.asarray(signal.timestamps, dtype=np.float64), source.path, axis=axis
            )
            values = np.asarray(signal.samples, dtype=np.float64)
            channels.append(Channel(signal.name, signal.unit or None, values, source.path, time=time, axis=axis))
        notes = tuple(f"{name} left out: its conversion is a formula, which is not evaluated" for name in formulas)
        if not channels:
            found = "; ".join(("holds no channel of numbers", *notes))
            raise InputError(source.path, found, "allowed: channels of samples")
        return Recording(with_shared_times(channels), self.format, source.path, notes=notes)


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
