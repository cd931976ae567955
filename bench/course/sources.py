"""Where the values of an axis come from: rig file, motor catalogue with its own sources, or the embedded rig."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.assets import asset
from bench.rig.catalogue import motor_sources
from bench.structured import read_toml

RIG_FILE, DATASHEET, ASSUMED, COURSE, EMBEDDED = "rig file", "datasheet", "assumed", "course", "embedded rig"

#: Rig of the simulated lab axis.
LAB = asset("data", "rigs", "lab.toml")
#: Words that a source in the motor catalogue begins with, and what they are called in a report.
_CATALOGUE = (("assumed", ASSUMED), ("datasheet", DATASHEET), ("the course", COURSE))


@dataclass(frozen=True)
class Sources:
    """Whence every value of an axis is.

    Attributes:
        given: tables of the rig file as TOML has them; empty where there is none.
        model: of the motor in the catalogue, for values that the rig file does not give.
    """

    given: Mapping[str, Any]
    model: str | None

    @classmethod
    def of(cls, path: Path | None) -> Sources:
        """Of a rig file that was read before, or of the embedded rig alone."""
        given = {} if path is None else read_toml(path, "a rig file")
        motor = given.get("motor", embedded()["motor"])
        return cls(given, motor.get("model"))

    def __call__(self, table: str, key: str) -> str:
        """Source of `[table] key`."""
        if key in self.given.get(table, {}):
            return RIG_FILE
        entry = motor_sources(self.model) if table == "motor" and self.model is not None else {}
        if key in entry:
            text = entry[key][1]
            return next((word for start, word in _CATALOGUE if text.startswith(start)), "motor catalogue")
        return EMBEDDED


def embedded() -> dict[str, Any]:
    """The embedded rig's tables as TOML has them."""
    return tomllib.loads(LAB.read_text(encoding="utf-8"))


def joined(*sources: str) -> str:
    """Several sources of one number, each once."""
    return ", ".join(dict.fromkeys(sources))
