"""What there is to do for a manifest: a job and a key for each recording, or why it cannot even be begun.

The key is a hash of what the result rests on: trace, rig, options and version. By it a result is found on disk.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from bench import __version__
from bench.bounds import bounds
from bench.errors import InputError
from bench.files import read_text, sha256, write_text
from bench.fleet.evaluate import CALLED, Job, Plain, marked, refused
from bench.fleet.manifest import Manifest
from bench.rig.rig import Rig, load_rig
from bench.structured import json_text, parse_json

SCHEMA = "bench.fleet.recording/1"


@dataclass(frozen=True)
class PlannedRecording:
    """One recording of the manifest.

    Attributes:
        key: of its result; empty where it cannot be begun.
        job: to be done for it; None where it cannot be begun.
        refusal: why not, as a result; None where it can.
        basis: what its result rests on, for the table.
    """

    key: str
    job: Job | None
    refusal: Plain | None
    basis: Plain


def plan(manifest: Manifest, diagnose: bool, progress: Callable[[float], None]) -> list[PlannedRecording]:
    """Every recording of the manifest, in its order.

    Args:
        manifest: of the fleet.
        diagnose: whether effects are sought too.
        progress: called with the share done.

    Raises:
        InputError: an effect of another package is none.
    """
    options: Plain = {"diagnose": diagnose, "bounds": [str(value) for value in asdict(bounds()).values()]}
    if diagnose:
        from bench.effects.catalogue import catalogue

        options["effects"] = sorted(catalogue())
    rigs: dict[str, tuple[Rig, str] | InputError] = {}
    planned = []
    columns = (manifest.located("file"), manifest.located("rig"), manifest.text("axis"))
    for number, (place, rig, axis) in enumerate(zip(*columns, strict=True)):
        if rig not in rigs:
            rigs[rig] = _rig(Path(rig))
        planned.append(_planned(place, axis, rigs[rig], options))
        progress(number / len(manifest))
    return planned


def _rig(path: Path) -> tuple[Rig, str] | InputError:
    """A rig with the hash of its file, under a name that is the same wherever it lies; or what is wrong with it."""
    try:
        return load_rig(path).model_copy(update={"source": "rig"}), sha256(path)
    except InputError as error:
        return InputError(error.where.replace(str(path), "rig"), error.found, error.allowed)


def _planned(place: str, axis: str, rig: tuple[Rig, str] | InputError, options: Plain) -> PlannedRecording:
    """A recording with all that its result depends on: beside trace, axis and rig the version and the options."""
    basis: Plain = {"version": __version__, "rig_sha256": None, "options": options}
    if isinstance(rig, InputError):
        return PlannedRecording("", None, refused(str(rig)), basis)
    basis["rig_sha256"] = rig[1]
    try:
        mark = marked(place) if "://" in place else sha256(Path(place))
    except InputError as error:
        return PlannedRecording("", None, refused(str(error).replace(place, CALLED)), basis)
    parts = {"trace": mark, "axis": axis, **basis}
    key = hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()
    return PlannedRecording(key, Job(place, axis, rig[0], options["diagnose"], bounds()), None, basis)


@dataclass(frozen=True)
class Store:
    """A folder of results, one file each, whole or not there."""

    folder: Path

    def path(self, key: str) -> Path:
        """Of a result's file; a folder holds a 256th of them, for a hundred thousand in one are slow."""
        return self.folder / key[:2] / f"{key}.json"

    def get(self, key: str) -> Plain | None:
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
