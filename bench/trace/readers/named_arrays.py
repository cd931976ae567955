"""Readers of arrays under names: NumPy's files, HDF5, and MATLAB's up to version 7 and of 7.3, which is HDF5.

Arrays of samples are channels, scalars and texts metadata.

In HDF5 a dataset is named by its path with dots, its unit is in an attribute `unit` or `units`. MATLAB stores
matrices transposed there and gives the class of a variable in `MATLAB_class`; structs are groups (MathWorks, "MAT-File
Versions").

The structure of older MAT files is checked first, for scipy trusts its type codes and crashes the process on damaged
ones. MAT-File Format (MathWorks, version 5): after a header of 128 bytes come elements, each a tag of type and length
and then data; a matrix is an element of elements: flags, dimensions, name, and data according to its class. They
carry no units.
"""

from __future__ import annotations

import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from io import BytesIO
from itertools import islice
from typing import Any

import numpy as np

from bench.bounds import MOST_COLUMNS, bounds, require_columns, require_expansion, shown, too_much
from bench.errors import InputError
from bench.trace.channel import Channel, Recording
from bench.trace.readers.containers import library, reading
from bench.trace.source import FileFormat, Source

#: Signals that a matrix may have, in addition to its samples.
MOST_SIGNALS = 1000

_NPY, _ZIP = b"\x93NUMPY", b"PK\x03\x04"
_HDF5 = b"\x89HDF\r\n\x1a\n"
_UNITS = ("unit", "units", "Unit", "Units", "UNIT")
_MAT, _MAT_OF_HDF5 = b"MATLAB ", b"MATLAB 7.3"
_HEADER = 128
_MATRIX, _COMPRESSED = 14, 15
_NUMBERS = frozenset((1, 2, 3, 4, 5, 6, 7, 9, 12, 13))
_TYPES = _NUMBERS | {_MATRIX, _COMPRESSED, 16, 17, 18}
_SPARSE, _CHARACTERS = 5, 4
_COMPLEX = 0x0800
#: Fields of iddata in a struct.
_IDDATA = ("OutputData", "InputData")
#: Structs and cells in one another.
_DEEPEST = 32
#: Elements of a matrix of class: flags, dimensions, name, and its data; numeric classes are 6 to 15.
_PARTS = {_CHARACTERS: 4, _SPARSE: 6, **dict.fromkeys(range(6, 16), 4)}


def is_samples(value: object) -> bool:
    """Whether a value is an array of samples: numbers, moments or fields of them, in one or two dimensions."""
    if not isinstance(value, np.ndarray) or value.size < 2 or value.ndim > 2:
        return False
    return value.dtype.kind in "fiubmM" or (value.dtype.names is not None and value.ndim == 1)


def channels_of(
    name: str, value: np.ndarray, path: str, unit: str | None = None, names: Mapping[int, Sequence[str]] | None = None
) -> Iterator[Channel]:
    """Channels of an array: `name`; of a matrix `name(:,1)` with a signal a column, `name(1,:)` with a signal a row.

    The longer side of a matrix is taken for its samples; where `names` has as many as the other, `name.elbow`.
    """
    if value.dtype.names is not None:
        for field in value.dtype.names:
            if value[field].dtype.kind in "fiubmM" and value[field].ndim == 1:
                yield from channels_of(f"{name}.{field}" if name else field, value[field], path)
        return
    if value.ndim == 1 or 1 in value.shape:
        yield _channel(name, value.reshape(-1), path, unit)
        return
    by_rows = value.shape[0] < value.shape[1]
    signals = value if by_rows else value.T
    known = (names or {}).get(len(signals))
    for number, signal in enumerate(signals if len(signals) <= MOST_SIGNALS else (), 1):
        label = f"{name}({number},:)" if by_rows else f"{name}(:,{number})"
        yield _channel(label if known is None else f"{name}.{known[number - 1]}", signal, path, unit)


def _channel(name: str, values: np.ndarray, path: str, unit: str | None) -> Channel:
    if values.dtype.kind in "mM":
        known = values[~np.isnat(values)]
        passed = (values - (known if known.size else values)[0]) / np.timedelta64(1, "ns") * 1e-9
        return Channel(name, "s", np.asarray(passed, dtype=np.float64), path, moments=True)
    return Channel(name, unit, np.ascontiguousarray(values, dtype=np.float64), path)


def _recording(
    kind: FileFormat, source: Source, channels: list[Channel], metadata: dict[str, str], missing: str, allowed: str
) -> Recording:
    if not channels:
        raise InputError(source.path, f"contains no {missing}", f"allowed: {allowed} of samples, one of them the time")
    return Recording(tuple(channels), kind.format, source.path, metadata)


def _is_numpy(source: Source) -> bool:
    return source.content.startswith(_NPY) or (source.content.startswith(_ZIP) and b".npy" in source.content[:4096])


def _read_numpy(source: Source) -> Recording:
    """Recording of `.npz` or `.npy`; columns of a lone matrix are `column 1`, ..."""
    channels: list[Channel] = []
    metadata: dict[str, str] = {}
    with reading(source.path, NUMPY.format):
        if source.content.startswith(_ZIP):
            with zipfile.ZipFile(BytesIO(source.content)) as archive:
                size = sum(member.file_size for member in archive.infolist())
            require_expansion(source.path, size, len(source.content))
        loaded = np.load(BytesIO(source.content), allow_pickle=False)
        lone = isinstance(loaded, np.ndarray)
        require_columns(source.path, len(loaded.dtype.names or ()) if lone else len(loaded.files))
        arrays = {"": loaded} if lone else {name: _array(loaded, name) for name in loaded.files}
    texts = [one for one in arrays.values() if one.dtype.kind == "U" and one.ndim == 1]
    names = {one.size: [str(text) for text in one] for one in texts}
    for name, value in arrays.items():
        if is_samples(value):
            channels.extend(channels_of(name, value, source.path, names=names))
        elif value.ndim == 0:
            metadata[name] = str(value)
    if lone and loaded.dtype.names is None:
        channels = [replace(channel, name=f"column {number}") for number, channel in enumerate(channels, 1)]
    return _recording(NUMPY, source, channels, metadata, "array of numbers", "arrays")


def _array(loaded: np.lib.npyio.NpzFile, name: str) -> np.ndarray:
    """An array of a zip; an empty one where it has Python objects, which are not loaded, or another file."""
    try:
        value = loaded[name]
    except ValueError as error:
        if "pickle" in str(error):
            return np.empty(0)
        raise
    return value if isinstance(value, np.ndarray) else np.empty(0)


def _read_hdf5(source: Source) -> Recording:
    h5py = library("h5py", source.path, HDF5.format)
    channels: list[Channel] = []
    metadata: dict[str, str] = {}
    with reading(source.path, HDF5.format), h5py.File(BytesIO(source.content), "r") as file:
        found = list(islice(_datasets(file, h5py, "", set()), MOST_COLUMNS + 1))
        require_columns(source.path, len(found))
        size = sum(dataset.nbytes for _, dataset in found if dataset.shape is not None)
        require_expansion(source.path, size, len(source.content))
        for name, dataset in found:
            channels.extend(_channels_of_dataset(name, dataset, metadata, source.path))
    return _recording(HDF5, source, channels, metadata, "numeric dataset", "datasets")


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


def _channels_of_dataset(name: str, dataset: Any, metadata: dict[str, str], path: str) -> Iterator[Channel]:  # noqa: ANN401
    unit = next((_text(dataset.attrs[key]) for key in _UNITS if key in dataset.attrs), None)
    matlab = _text(dataset.attrs.get("MATLAB_class", ""))
    if dataset.shape is None or dataset.dtype.kind not in "fiubV" or len(dataset.shape) > 2:
        return
    value = np.asarray(dataset[()])
    if matlab == "char":
        metadata[name] = "".join(chr(code) for code in np.ravel(value, order="F")[:1000])
    elif value.size == 1 and value.dtype.names is None:
        metadata[name] = str(value.reshape(-1)[0])
    elif is_samples(value):
        yield from channels_of(name, value.T if matlab and value.ndim == 2 else value, path, unit)


def _text(value: object) -> str:
    plain = value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
    return plain.decode("utf-8", errors="replace") if isinstance(plain, bytes) else str(plain)


def _read_mat(source: Source) -> Recording:
    """Recording of a MAT file; fields of a struct are `struct.field`."""
    channels: list[Channel] = []
    metadata: dict[str, str] = {}
    for name, value in _variables(load_mat(source.content, source.path)):
        if isinstance(value, dict):
            channels.extend(_of_iddata(name, value, source.path))
        elif isinstance(value, np.ndarray) and is_samples(value):
            channels.extend(channels_of(name, value, source.path))
        elif np.isscalar(value) or (isinstance(value, np.ndarray) and value.size == 1):
            metadata[name] = str(value)
    if not channels and b"MCOS" in _plain_start(source.content):
        found = "contains an object of MATLAB (table, timetable, timeseries, iddata), which only MATLAB opens"
        lines = "for a table T: writetable(T, 'run.csv'); for iddata d: s = get(d); save('run.mat', 's', '-v7')"
        raise InputError(source.path, found, f"allowed: numeric vectors; in MATLAB, {lines}")
    return _recording(MAT, source, channels, metadata, "numeric vector", "vectors")


def _plain_start(content: bytes) -> bytes:
    """The first variable as it is stored, unpacked."""
    (kind,) = struct.unpack("<I", content[_HEADER : _HEADER + 4].ljust(4))
    packed = content[_HEADER + 8 :]
    return zlib.decompressobj().decompress(packed, 4096) if kind == _COMPRESSED else packed[:4096]


NUMPY = FileFormat("NumPy", (".npz", ".npy"), _is_numpy, _read_numpy)
#: Perhaps behind the header of a MAT file.
HDF5 = FileFormat("HDF5", (".h5", ".hdf5"), lambda s: _HDF5 in (s.content[:8], s.content[512:520]), _read_hdf5)
MAT = FileFormat(
    "MAT",
    (".mat",),
    lambda source: source.content.startswith(_MAT) and not source.content.startswith(_MAT_OF_HDF5),
    _read_mat,
)


def load_mat(content: bytes, where: str) -> dict[str, Any]:
    """Variables of a MAT file up to version 7, structs as dictionaries; InputError where it is damaged or too large."""
    from scipy.io import loadmat  # 0.05 s, for one format of ten

    with reading(where, "MAT"):
        if content.startswith(_MAT):
            _check_structure(content, where)
        return loadmat(BytesIO(content), simplify_cells=True)


def _variables(content: dict, prefix: str = "") -> Iterator[tuple[str, object]]:
    """Variables by their names; of structs `struct.field`, of cells and arrays of structs `cell.1`; iddata whole."""
    for name, value in content.items():
        if isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object):
            value = {str(place): one for place, one in enumerate(np.ravel(np.array(value, dtype=object)), 1)}
        if isinstance(value, dict) and all(np.ndim(value.get(data, "")) for data in _IDDATA):
            yield prefix + name, value
        elif isinstance(value, dict):
            yield from _variables(value, f"{prefix}{name}.")
        elif not name.startswith("__"):
            yield prefix + name, value


def _of_iddata(name: str, data: dict, path: str) -> Iterator[Channel]:
    """Channels of iddata that was saved as a struct (System Identification Toolbox), under its names and units."""
    count = len(data[_IDDATA[0]])
    instants = np.ravel(data.get("SamplingInstants", ()))
    if instants.size != count:
        instants = np.ravel(data.get("Tstart", ())).sum() + np.arange(count) * float(data["Ts"])
    yield Channel(f"{name}.time", str(data.get("TimeUnit", "seconds")), instants.astype(np.float64), path)
    for side in ("Output", "Input"):
        names, units = (np.atleast_1d(data.get(f"{side}{what}", ())) for what in ("Name", "Unit"))
        for k, values in enumerate(np.reshape(data[f"{side}Data"], (count, -1)).T):
            unit = str(units[k]) if k < units.size else ""
            label = str(names[k]) if k < names.size else f"{side.lower()}{k + 1}"
            yield Channel(f"{name}.{label}", unit or None, np.array(values, dtype=np.float64), path)


def _check_structure(content: bytes, where: str) -> None:
    """Walk through all elements; ValueError where they are damaged, InputError where they expand too far."""
    if content[126:128] not in (b"IM", b"MI"):
        raise ValueError("no byte order in the header")
    order = "<" if content[126:128] == b"IM" else ">"
    left = most = bounds().most(len(content))
    for kind, data in _elements(memoryview(content)[_HEADER:], order):
        if kind == _MATRIX:
            _check_matrix(data, order)
        elif kind == _COMPRESSED:
            stream = zlib.decompressobj()
            unpacked = stream.decompress(data, left + 1)
            left -= len(unpacked)
            if left < 0:
                raise too_much(where, len(content), f"more than {shown(most)}")
            if not stream.eof:
                raise ValueError("a compressed element is cut off")
            for inner, part in _elements(memoryview(unpacked), order):
                if inner == _COMPRESSED:
                    raise ValueError("a compressed element in a compressed element")
                if inner == _MATRIX:
                    _check_matrix(part, order)


def _elements(data: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Type and data of each element."""
    start = 0
    while start < len(data):
        if start + 8 > len(data):
            raise ValueError("an element is cut off")
        kind, size = struct.unpack_from(f"{order}II", data, start)
        begin = start + 8
        if kind >> 16:  # a small element: its length in the upper half of the type, its data inside the tag
            kind, size, begin = kind & 0xFFFF, kind >> 16, start + 4
        if kind not in _TYPES or begin + size > len(data):
            raise ValueError(f"an element of type {kind} and {size} bytes")
        yield kind, data[begin : begin + size]
        start = begin + size + (0 if kind == _COMPRESSED else -size % (4 if begin == start + 4 else 8))


def _check_matrix(data: memoryview, order: str, depth: int = 0) -> None:
    if depth > _DEEPEST:
        raise ValueError(f"more than {_DEEPEST} matrices in one another")
    parts = list(_elements(data, order))
    if not parts:
        return  # an empty cell
    kind, flags = parts[0]
    if kind not in _NUMBERS or len(flags) != 8:
        raise ValueError("a matrix without flags")
    (flag,) = struct.unpack_from(f"{order}I", flags)
    wanted = _PARTS.get(flag & 0xFF, 0)
    right = len(parts) == wanted + bool(flag & _COMPLEX) and not {kind for kind, _ in parts} & {_MATRIX, _COMPRESSED}
    if wanted and not right:
        raise ValueError(f"a matrix of {len(parts)} parts")
    for kind, part in parts:
        if kind == _MATRIX:
            _check_matrix(part, order, depth + 1)
