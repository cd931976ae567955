"""Reader of NumPy files: every array of numbers a channel; what is no array of samples is told as metadata."""

from __future__ import annotations

import zipfile
from io import BytesIO

import numpy as np

from bench.bounds import require_expansion
from bench.errors import InputError
from bench.trace.channel import Channel, Recording
from bench.trace.readers.containers import channels_of, is_samples, reading
from bench.trace.source import Source

_NPY, _ZIP = b"\x93NUMPY", b"PK\x03\x04"


class Npz:
    """Files of NumPy, see the module."""

    format = "NumPy"
    endings = (".npz", ".npy")

    def recognises(self, source: Source) -> bool:
        """Whether the file is an array of NumPy, or a zip of such."""
        return source.content.startswith(_NPY) or (source.content.startswith(_ZIP) and b".npy" in source.content[:4096])

    def read(self, source: Source) -> Recording:
        """Recording of `.npz` or `.npy`; columns of a lone matrix are `column 1`, ...

        Raises:
            InputError: damaged, or without an array of numbers.
        """
        channels: list[Channel] = []
        metadata: dict[str, str] = {}
        with reading(source.path, self.format):
            _require_bounds(source)
            loaded = np.load(BytesIO(source.content), allow_pickle=False)
            names = [""] if isinstance(loaded, np.ndarray) else loaded.files
            arrays = {name: loaded if isinstance(loaded, np.ndarray) else _array(loaded, name) for name in names}
        for name, value in arrays.items():
            if is_samples(value):
                channels.extend(channels_of(name, value, source.path))
            elif value is not None and value.ndim == 0:
                metadata[name] = str(value)
        if not channels:
            raise InputError(
                source.path, "holds no array of numbers", "allowed: arrays of samples, one of them the time"
            )
        if "" in arrays and arrays[""].dtype.names is None:
            channels = [Channel(f"column {n}", c.unit, c.values, c.origin) for n, c in enumerate(channels, 1)]
        return Recording(tuple(channels), self.format, source.path, metadata)


def _require_bounds(source: Source) -> None:
    """InputError where a zip's arrays would expand to more than they may."""
    if source.content.startswith(_ZIP):
        with zipfile.ZipFile(BytesIO(source.content)) as archive:
            size = sum(member.file_size for member in archive.infolist())
        require_expansion(source.path, size, len(source.content))


def _array(loaded: np.lib.npyio.NpzFile, name: str) -> np.ndarray:
    """An array of a zip; an empty one where it holds Python objects, which are not loaded."""
    try:
        return loaded[name]
    except ValueError as error:
        if "pickle" in str(error):
            return np.empty(0)
        raise
