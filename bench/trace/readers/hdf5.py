"""Reader of HDF5, MATLAB's files of version 7.3 among them, by h5py.

Every numeric dataset is a channel named by its path with dots, its unit in an attribute `unit` or `units`. MATLAB
stores matrices transposed and says the class of a variable in `MATLAB_class`; structs are groups (MathWorks, "MAT-File
Versions").
"""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from typing import Any

import numpy as np

from bench.bounds import require_expansion
from bench.errors import InputError
from bench.trace.channel import Channel, Recording
from bench.trace.readers.containers import channels_of, is_samples, library, reading
from bench.trace.source import Source

_MAGIC = b"\x89HDF\r\n\x1a\n"
_UNITS = ("unit", "units", "Unit", "Units", "UNIT")


class Hdf5:
    """HDF5, see the module."""

    format = "HDF5"
    endings = (".h5", ".hdf5")

    def recognises(self, source: Source) -> bool:
        """Whether the file is HDF5, perhaps behind the header of a MAT file."""
        return source.content.startswith(_MAGIC) or source.content[512:520] == _MAGIC

    def read(self, source: Source) -> Recording:
        """Recording of an HDF5 file; scalars and texts become metadata.

        Raises:
            InputError: h5py is not installed; damaged, or without a numeric dataset.
        """
        h5py = library("h5py", "h5py", "hdf5", source.path, self.format)
        channels: list[Channel] = []
        metadata: dict[str, str] = {}
        with reading(source.path, self.format), h5py.File(BytesIO(source.content), "r") as file:
            found = list(_datasets(file, h5py, "", set()))
            size = sum(dataset.nbytes for _, dataset in found if dataset.shape is not None)
            require_expansion(source.path, size, len(source.content))
            for name, dataset in found:
                channels.extend(_channels(name, dataset, metadata, source.path))
        if not channels:
            raise InputError(
                source.path, "holds no numeric dataset", "allowed: datasets of samples, one of them the time"
            )
        return Recording(tuple(channels), self.format, source.path, metadata)


def _datasets(group: Any, h5py: Any, prefix: str, seen: set[int]) -> Iterator[tuple[str, Any]]:  # noqa: ANN401
    """Datasets in a group and the groups in it, each once, whatever links lead to it; by their address in the file."""
    for name in group:
        link = group.get(name, getlink=True)
        if name.startswith("#") or not isinstance(link, h5py.HardLink):
            continue  # MATLAB's references, and what lies in other files
        value = group[name]
        address = h5py.h5o.get_info(value.id).addr
        if address in seen:
            continue
        seen.add(address)
        if isinstance(value, h5py.Group):
            yield from _datasets(value, h5py, f"{prefix}{name}.", seen)
        elif isinstance(value, h5py.Dataset) and not value.external and not value.is_virtual:  # those are other files
            yield prefix + name, value


def _channels(name: str, dataset: Any, metadata: dict[str, str], path: str) -> Iterator[Channel]:  # noqa: ANN401
    unit = next((_text(dataset.attrs[key]) for key in _UNITS if key in dataset.attrs), None)
    matlab = _text(dataset.attrs.get("MATLAB_class", ""))
    if dataset.shape is None or dataset.dtype.kind not in "fiubV" or len(dataset.shape) > 2:
        return
    if matlab == "char":
        metadata[name] = "".join(chr(code) for code in np.ravel(dataset[()], order="F")[:1000])
        return
    value = np.asarray(dataset[()])
    if value.size == 1 and value.dtype.names is None:
        metadata[name] = str(value.reshape(-1)[0])
    elif is_samples(value):
        yield from channels_of(name, value.T if matlab and value.ndim == 2 else value, path, unit)


def _text(value: object) -> str:
    plain = value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
    return plain.decode("utf-8", errors="replace") if isinstance(plain, bytes) else str(plain)
