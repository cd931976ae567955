"""Results of single recordings on disk: one file each, whole or not there, found by what the result rests on."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.errors import InputError
from bench.files import read_text, write_text
from bench.structured import json_text, parse_json

SCHEMA = "bench.fleet.recording/1"


@dataclass(frozen=True)
class Store:
    """A folder of results."""

    folder: Path

    def path(self, key: str) -> Path:
        """Of a result's file; a folder holds a 256th of them, for a hundred thousand in one are slow."""
        return self.folder / key[:2] / f"{key}.json"

    def get(self, key: str) -> dict[str, Any] | None:
        """A result; None if there is none, or it is damaged."""
        path = self.path(key)
        if not path.exists():
            return None
        try:
            found = parse_json(read_text(path, "a result"), path)
        except InputError:
            return None
        return found if isinstance(found, dict) and found.get("schema") == SCHEMA else None

    def put(self, key: str, result: Mapping[str, Any]) -> None:
        """Keep a result.

        Raises:
            InputError: the folder cannot be written to.
        """
        write_text(self.path(key), json_text({"schema": SCHEMA, **result}) + "\n")


def key_of(parts: Mapping[str, Any]) -> str:
    """Hash of what a result rests on, in hexadecimal digits.

    Args:
        parts: JSON's kinds of values: hashes of trace and rig, options, version.
    """
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()
