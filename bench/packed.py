"""A result with all its parts in one file, to be had again as it was: numbers and texts as JSON, arrays with them.

The file (NumPy's .npz) names dataclasses of the bench and effects of the catalogue; nothing in it is run.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from bench.arrays import Array
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.errors import InputError
from bench.files import read_bytes, whole
from bench.structured import parse_json

#: Name of what is no array.
_PARTS = "result"
#: What is raised by a file that another version, or somebody else, wrote.
_UNKNOWN = (ValueError, KeyError, TypeError, AttributeError, ImportError, OSError, EOFError, zipfile.BadZipFile)
#: Kinds of a series of values, by name.
_SERIES = {kind.__name__: kind for kind in (tuple, list, frozenset)}


def pack(path: Path, result: object) -> Path:
    """Write a dataclass of the bench whole into a file, whose path is returned; InputError where it cannot be written.

    TypeError: a part of it is neither a dataclass, an effect, an array, a number nor a text, nor composed of those.
    """
    arrays: dict[str, Array] = {}
    parts = json.dumps(_pack(result, arrays))
    with whole(path) as temporary, temporary.open("wb") as file:
        arrays[_PARTS] = np.array(parts)
        np.savez_compressed(file, allow_pickle=False, **arrays)
    return path


def unpack(path: Path, kind: type) -> Any:  # noqa: ANN401 - of this kind
    """What `pack` wrote of a result of this kind; InputError: no such file, or of another version or somebody else."""
    content = read_bytes(path, "a packed result")
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        result = _unpack(parse_json(str(arrays[_PARTS]), path), arrays)
    except _UNKNOWN as error:
        found = f"contains no result of this version ({error})"
        raise InputError(path, found, "allowed: what the same version's `save` wrote") from error
    if not isinstance(result, kind):
        raise InputError(path, f"contains another result ({type(result).__name__})", f"allowed: {kind.__name__}")
    return result


def _pack(value: object, arrays: dict[str, Array]) -> Any:  # noqa: ANN401 - what JSON can hold
    match value:
        case None | bool() | int() | float() | str():
            return value
        case Effect():
            return {"effect": value.name}
        case np.generic():
            return value.item()
        case np.ndarray():
            name = f"array{len(arrays)}"
            arrays[name] = value
            return {"array": name}
        case Mapping():
            return {"mapping": [[_pack(key, arrays), _pack(one, arrays)] for key, one in value.items()]}
        case tuple() | list() | frozenset():
            kind = next(name for name, kind in _SERIES.items() if isinstance(value, kind))
            return {kind: [_pack(one, arrays) for one in value]}
        case _ if is_dataclass(value):
            known = {one.name: _pack(getattr(value, one.name), arrays) for one in fields(value) if one.init}
            return {"class": f"{type(value).__module__}:{type(value).__qualname__}", "fields": known}
    raise TypeError(f"found {type(value).__name__}, which cannot be stored")


def _unpack(packed: Any, arrays: Mapping[str, Array]) -> Any:  # noqa: ANN401 - whatever was packed
    match packed:
        case {"effect": name}:
            return catalogue()[name]
        case {"array": name}:
            return arrays[name]
        case {"mapping": pairs}:
            return {_unpack(key, arrays): _unpack(one, arrays) for key, one in pairs}
        case {"class": name, "fields": known}:
            module, _, kind = name.partition(":")
            found = getattr(import_module(module), kind) if module.startswith("bench.") else None
            if not (isinstance(found, type) and is_dataclass(found)):
                raise TypeError(f"found {name}, which is no dataclass of the bench")
            return found(**{key: _unpack(one, arrays) for key, one in known.items()})
        case {**one} if len(one) == 1 and (kind := next(iter(one))) in _SERIES:
            return _SERIES[kind](_unpack(each, arrays) for each in one[kind])
        case _:
            return packed
