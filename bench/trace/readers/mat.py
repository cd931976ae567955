"""Reader of MATLAB files up to version 7: every numeric vector a channel, scalars as metadata. They carry no units."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from typing import Any

import numpy as np

from bench.errors import InputError
from bench.trace.channel import Channel, Recording
from bench.trace.readers.mat_structure import check_structure
from bench.trace.source import Source

FORMAT = "MAT"
ENDINGS = (".mat",)

_MAGIC = b"MATLAB "


def recognises(source: Source) -> bool:
    """Whether the file begins as MAT files of version 5 and later do."""
    return source.content.startswith(_MAGIC)


def read(source: Source) -> Recording:
    """Recording of a MAT file; fields of a struct are named `struct.field`, columns of a matrix `name(:,1)`.

    Raises:
        InputError: version 7.3 (HDF5), truncated, damaged, or without a numeric vector.
    """
    content = load(source.content, source.path)
    channels, metadata = [], {}
    for name, value in _variables(content):
        if isinstance(value, np.ndarray) and value.dtype.kind in "fiub" and value.size > 1 and value.ndim <= 2:
            channels.extend(_channels(name, value, source.path))
        elif np.isscalar(value) or (isinstance(value, np.ndarray) and value.size == 1):
            metadata[name] = str(value)
    if not channels:
        raise InputError(source.path, "holds no numeric vector", "allowed: vectors of samples, one of them the time")
    return Recording(tuple(channels), FORMAT, source.path, metadata)


def load(content: bytes, where: str) -> dict[str, Any]:
    """Variables of a MAT file, structs as dictionaries.

    Raises:
        InputError: version 7.3 (HDF5), truncated, damaged, or of more than a file may expand to; names `where`.
    """
    from scipy.io import loadmat  # 0.05 s, for one format of ten

    if content.startswith((b"MATLAB 7.3", b"\x89HDF")):
        raise InputError(where, "found MAT version 7.3 (HDF5)", "allowed: version 7 or older; save with '-v7'")
    try:
        if content.startswith(_MAGIC):
            check_structure(content, where)
        return loadmat(BytesIO(content), simplify_cells=True)
    except InputError:
        raise
    except Exception as error:  # scipy raises nearly any exception on a damaged file
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        found = f"the MAT file is truncated or damaged ({reason})"
        raise InputError(where, found, "allowed: a complete MAT file") from error


def _variables(content: dict, prefix: str = "") -> Iterator[tuple[str, object]]:
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _variables(value, f"{prefix}{name}.")
        elif not name.startswith("__"):
            yield prefix + name, value


def _channels(name: str, value: np.ndarray, path: str) -> Iterator[Channel]:
    columns = value.reshape(-1, 1) if 1 in value.shape or value.ndim == 1 else value
    for number, column in enumerate(columns.T, 1):
        label = name if columns.shape[1] == 1 else f"{name}(:,{number})"
        yield Channel(label, None, np.ascontiguousarray(column, dtype=np.float64), path)
