"""Motor catalogue: one TOML file a motor in `data/motors/`, every value with its source."""

from __future__ import annotations

import tomllib
from typing import Any

from bench.assets import asset
from bench.errors import InputError
from bench.names import nearest


def motor_names() -> list[str]:
    """Names of the motors in the catalogue."""
    return sorted(path.stem for path in asset("data", "motors").glob("*.toml"))


def motor_sources(name: str) -> dict[str, tuple[Any, str]]:
    """Value (with unit) and source of every quantity known about a motor; name must be in the catalogue."""
    entry = tomllib.loads(asset("data", "motors", f"{name}.toml").read_text(encoding="utf-8"))
    return {key: (item["value"], item["source"]) for key, item in entry.items()}


def catalogue_motor(name: object, where: str) -> dict[str, Any]:
    """Motor table of a catalogue entry, as it would stand in a rig file.

    Raises:
        InputError: no motor of this name.
    """
    names = motor_names()
    if not isinstance(name, str) or name not in names:
        raise InputError(
            where, f"no motor {name!r} in the catalogue{nearest(str(name), names)}", f"allowed: {', '.join(names)}"
        )
    return {key: value for key, (value, _) in motor_sources(name).items()}
