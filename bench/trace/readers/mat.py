"""Reader of MATLAB files up to version 7 (7.3 is HDF5): vectors are channels, scalars metadata. They carry no units.

Their structure is checked first, for scipy trusts its type codes and crashes the process on damaged ones. MAT-File
Format (MathWorks, version 5): after a header of 128 bytes come elements, each a tag of type and length and then data; a
matrix is an element made of elements: flags, dimensions, name, and data according to its class.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import Any

import numpy as np

from bench.bounds import bounds, shown, too_much
from bench.errors import InputError
from bench.trace.channel import Recording
from bench.trace.readers.containers import channels_of, is_samples, reading
from bench.trace.source import Source

_MAGIC, _HDF5 = b"MATLAB ", b"MATLAB 7.3"
_HEADER = 128
_MATRIX, _COMPRESSED = 14, 15
_NUMBERS = frozenset((1, 2, 3, 4, 5, 6, 7, 9, 12, 13))
_TYPES = _NUMBERS | {_MATRIX, _COMPRESSED, 16, 17, 18}
_SPARSE, _CHARACTERS = 5, 4
_COMPLEX = 0x0800
#: Structs and cells in one another.
_DEEPEST = 32
#: Elements of a matrix of class: flags, dimensions, name, and its data; numeric classes are 6 to 15.
_PARTS = {_CHARACTERS: 4, _SPARSE: 6, **dict.fromkeys(range(6, 16), 4)}


class Mat:
    """MATLAB files up to version 7, see the module."""

    format = "MAT"
    endings = (".mat",)

    def recognises(self, source: Source) -> bool:
        """Whether the file begins as MAT files of version 5 to 7 do."""
        return source.content.startswith(_MAGIC) and not source.content.startswith(_HDF5)

    def read(self, source: Source) -> Recording:
        """Recording of a MAT file; fields of a struct are `struct.field`, signals of a matrix as `channels_of` says.

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
            raise InputError(
                source.path, "holds no numeric vector", "allowed: vectors of samples, one of them the time"
            )
        return Recording(tuple(channels), self.format, source.path, metadata)


def load(content: bytes, where: str) -> dict[str, Any]:
    """Variables of a MAT file, structs as dictionaries.

    Raises:
        InputError: truncated, damaged, or of more than a file may expand to; names `where`.
    """
    from scipy.io import loadmat  # 0.05 s, for one format of ten

    with reading(where, "MAT"):
        if content.startswith(_MAGIC):
            check_structure(content, where)
        return loadmat(BytesIO(content), simplify_cells=True)


def _variables(content: dict, prefix: str = "") -> Iterator[tuple[str, object]]:
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _variables(value, f"{prefix}{name}.")
        elif not name.startswith("__"):
            yield prefix + name, value


def check_structure(content: bytes, where: str) -> None:
    """Walk through all elements.

    Raises:
        ValueError: a type that is none, a length beyond the file, parts missing from a matrix, or cells in cells in ...
        InputError: it expands to more than it may; names `where`.
    """
    if content[126:128] not in (b"IM", b"MI"):
        raise ValueError("no byte order in the header")
    expanded = 0
    order = "<" if content[126:128] == b"IM" else ">"
    for kind, begin, end in _elements(content, order, _HEADER, len(content)):
        if kind == _COMPRESSED:
            data = _inflated(content[begin:end], bounds().most(len(content)) - expanded)
            if data is None:
                raise too_much(where, len(content), f"more than {shown(bounds().most(len(content)))}")
            expanded += len(data)
            _check(data, order)
        elif kind == _MATRIX:
            _check_matrix(content, order, begin, end)


def _inflated(data: bytes, most: int) -> bytes | None:
    """What a compressed element holds; None where that is more than `most` bytes."""
    stream = zlib.decompressobj()
    found = stream.decompress(data, most + 1)
    if not stream.eof and len(found) <= most:
        raise ValueError("a compressed element is cut off")
    return found if len(found) <= most else None


def _check(data: bytes, order: str) -> None:
    for kind, begin, end in _elements(data, order, 0, len(data)):
        if kind == _COMPRESSED:
            raise ValueError("a compressed element in a compressed element")
        if kind == _MATRIX:
            _check_matrix(data, order, begin, end)


def _elements(data: bytes, order: str, start: int, stop: int) -> Iterator[tuple[int, int, int]]:
    """Type, begin and end of the data of each element."""
    while start < stop:
        if start + 8 > stop:
            raise ValueError("an element is cut off")
        kind, size = struct.unpack_from(f"{order}II", data, start)
        begin = start + 8
        if kind >> 16:  # a small element: its length in the upper half of the type, its data inside the tag
            kind, size, begin = kind & 0xFFFF, kind >> 16, start + 4
        if kind not in _TYPES or begin + size > stop:
            raise ValueError(f"an element of type {kind} and {size} bytes")
        yield kind, begin, begin + size
        padding = 0 if kind == _COMPRESSED else -size % (4 if begin == start + 4 else 8)
        start = begin + size + padding


def _check_matrix(data: bytes, order: str, begin: int, end: int, depth: int = 0) -> None:
    if depth > _DEEPEST:
        raise ValueError(f"more than {_DEEPEST} matrices in one another")
    parts = list(_elements(data, order, begin, end))
    if not parts:
        return  # an empty cell
    kind, first, last = parts[0]
    if kind not in _NUMBERS or last - first != 8:
        raise ValueError("a matrix without flags")
    (flags,) = struct.unpack_from(f"{order}I", data, first)
    wanted = _PARTS.get(flags & 0xFF)
    if wanted is not None and (
        len(parts) != wanted + bool(flags & _COMPLEX)
        or any(kind not in _NUMBERS | {16, 17, 18} for kind, _, _ in parts)
    ):
        raise ValueError(f"a matrix of {len(parts)} parts")
    for kind, first, last in parts:
        if kind == _MATRIX:
            _check_matrix(data, order, first, last, depth + 1)
