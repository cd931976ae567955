"""Reader of MATLAB files up to version 7 (7.3 is HDF5): vectors are channels, scalars metadata. They carry no units."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from typing import Any

import numpy as np

from bench.errors import InputError
from bench.trace.channel import Recording
from bench.trace.readers.arrays import channels_of, is_samples
from bench.trace.readers.mat_structure import check_structure
from bench.trace.source import Source

FORMAT = "MAT"
ENDINGS = (".mat",)

_MAGIC, _HDF5 = b"MATLAB ", b"MATLAB 7.3"


def recognises(source: Source) -> bool:
    """Whether the file begins as MAT files of version 5 to 7 do."""
    return source.content.startswith(_MAGIC) and not source.content.startswith(_HDF5)


def read(source: Source) -> Recording:
    """Recording of a MAT file; fields of a struct are named `struct.field`, signals of a matrix as `channels_of` says.

    Raises:
        InputError: truncated, damaged, or without a numeric vector.
    """
    content = load(source.content, source.path)
    channels, metadata = [], {}
    for name, value in _variables(content):
        if is_samples(value):
            channels.extend(channels_of(name, np.asarray(value), source.path))
        elif np.isscalar(value) or (isinstance(value, np.ndarray) and value.size == 1):
            metadata[name] = str(value)
    if not channels:
        raise InputError(source.path, "holds no numeric vector", "allowed: vectors of samples, one of them the time")
    return Recording(tuple(channels), FORMAT, source.path, metadata)


def load(content: bytes, where: str) -> dict[str, Any]:
    """Variables of a MAT file, structs as dictionaries.

    Raises:
        InputError: truncated, damaged, or of more than a file may expand to; names `where`.
    """
    from scipy.io import loadmat  # 0.05 s, for one format of ten

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
