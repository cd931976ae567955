"""Results of a fleet's recordings on disk: a file each, whole or not there, and what a result has to be."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from bench.errors import InputError
from bench.files import read_text, write_text
from bench.structured import json_text, parse_json

SCHEMA = "bench.fleet.recording/1"
#: One number with its unit, or what was found: as JSON has it.
Plain = dict[str, Any]
#: A number as JSON has it, whose square is one too; None where it is not known.
_Finite = Annotated[float, Field(ge=-1e150, le=1e150)] | None


def digest(content: Mapping[str, Any]) -> str:
    """SHA-256 of plain data in hexadecimal digits."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


class _Part(BaseModel):
    model_config = ConfigDict(strict=True)


class _Number(_Part):
    value: _Finite
    unit: str
    std_error: _Finite
    ci95: Annotated[list[_Finite], Field(min_length=2, max_length=2)]


class _OfCheck(_Part):
    name: str
    status: str
    found: str
    advice: str


class _OfEffect(_Part):
    name: str
    parameters: dict[str, _Number]


class _OfGap(_Part):
    unit: str
    noise_floor: _Finite
    before: _Finite
    after: _Finite


class _Result(_Part):
    """What a result has to be to be used in a table; one that is not is as one that is not there."""

    warnings: list[str] = []
    verdict: str | None = None
    effects: list[_OfEffect] = []
    gap: dict[Literal["torque", "velocity"], _OfGap] = {}
    trace_sha256: str | None = None


class _Done(_Result):
    status: Literal["done"]
    reason: None
    parameters: dict[str, _Number]
    checks: list[_OfCheck]
    explained: _Finite


class _NotDone(_Result):
    status: Literal["missing", "refused", "failed", "timed_out"]
    reason: str
    parameters: dict[str, _Number] = {}
    checks: list[_OfCheck] = []
    explained: _Finite = None


_KEPT = TypeAdapter(_Done | _NotDone)


@dataclass(frozen=True)
class Store:
    """A folder of results, one file each, whole or not there."""

    folder: Path

    def path(self, key: str) -> Path:
        """Of a result's file; a folder has a 256th of them, for a hundred thousand in one are slow."""
        return self.folder / key[:2] / f"{key}.json"

    def get(self, key: str) -> Plain | None:
        """A result; None if there is none, or it is not as it was put."""
        path = self.path(key)
        if not path.exists():
            return None
        try:
            found = parse_json(read_text(path, "a result", replaced=True), path)
        except InputError:
            return None
        sound = isinstance(found, dict) and found.pop("sha256", None) == digest(found)
        if not sound or found.get("schema") != SCHEMA:
            return None
        try:
            return _KEPT.validate_python(found).model_dump(exclude_unset=True)
        except ValidationError:
            return None

    def put(self, key: str, result: Mapping[str, Any]) -> None:
        """Keep a result; InputError where the folder cannot be written to."""
        content = {"schema": SCHEMA, **result}
        write_text(self.path(key), json_text({**content, "sha256": digest(content)}) + "\n")
