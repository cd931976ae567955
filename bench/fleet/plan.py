"""What there is to do for a manifest: a task and a key for each recording, or why it cannot even be begun."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from bench import __version__
from bench.bounds import bounds
from bench.errors import InputError
from bench.files import sha256
from bench.fleet.manifest import Manifest
from bench.fleet.recording import CALLED, Plain, Task, refused
from bench.fleet.remote import marked
from bench.fleet.store import key_of
from bench.rig.rig import Rig, load_rig


@dataclass(frozen=True)
class Planned:
    """One recording of the manifest.

    Attributes:
        key: of its result; empty where it cannot be begun.
        task: to be done for it; None where it cannot be begun.
        refusal: why not, as a result; None where it can.
        basis: what its result rests on, for the table.
    """

    key: str
    task: Task | None
    refusal: Plain | None
    basis: Plain


def plan(manifest: Manifest, diagnose: bool, progress: Callable[[float], None]) -> list[Planned]:
    """Every recording of the manifest, in its order.

    Args:
        manifest: of the fleet.
        diagnose: whether effects are sought too.
        progress: called with the share done.

    Raises:
        InputError: an effect of another package is none.
    """
    options = _options(diagnose)
    rigs: dict[str, tuple[Rig, str] | InputError] = {}
    planned = []
    columns = (manifest.located("file"), manifest.located("rig"), manifest.text("axis"))
    for number, (place, rig, axis) in enumerate(zip(*columns, strict=True)):
        if rig not in rigs:
            rigs[rig] = _rig(Path(rig))
        planned.append(_planned(place, axis, rigs[rig], options))
        progress(number / len(manifest))
    return planned


def _options(diagnose: bool) -> dict[str, Any]:
    """All that a result depends on beside trace, rig and version."""
    options = {"diagnose": diagnose, "bounds": [str(value) for value in asdict(bounds()).values()]}
    if diagnose:
        from bench.effects.catalogue import catalogue

        options["effects"] = sorted(catalogue())
    return options


def _rig(path: Path) -> tuple[Rig, str] | InputError:
    """A rig with the hash of its file, under a name that is the same wherever it lies; or what is wrong with it."""
    try:
        return load_rig(path).model_copy(update={"source": "rig"}), sha256(path)
    except InputError as error:
        return InputError(error.where.replace(str(path), "rig"), error.found, error.allowed)


def _planned(place: str, axis: str, rig: tuple[Rig, str] | InputError, options: dict[str, Any]) -> Planned:
    basis: Plain = {"version": __version__, "rig_sha256": None, "options": options}
    if isinstance(rig, InputError):
        return Planned("", None, refused(str(rig)), basis)
    basis["rig_sha256"] = rig[1]
    try:
        mark = marked(place) if "://" in place else sha256(Path(place))
    except InputError as error:
        return Planned("", None, refused(str(error).replace(place, CALLED)), basis)
    task = Task(place, axis, rig[0], options["diagnose"], bounds())
    return Planned(key_of({"trace": mark, "axis": axis, **basis}), task, None, basis)
