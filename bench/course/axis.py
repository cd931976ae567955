"""The axis of the lab: its rig file, what the tasks take from it, and where each of its values comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from bench.assets import asset
from bench.errors import InputError
from bench.rig.limits import Circuit, peak_curve
from bench.rig.motor import TorqueConstant, motor_sources
from bench.rig.rig import Rig, load_rig
from bench.structured import read_toml

#: Rig of the simulated lab axis.
LAB = asset("data", "rigs", "lab.toml")
#: Mains voltage of the lab - V.
MAINS = 230.0
#: What to do where current and speed are counted in opposite directions.
TURN = 'turn one of them by a rig.toml next to it with [trace.columns] current = "-name of its column [unit]"'
#: Words that a source in the motor catalogue begins with, which a report calls it by.
_CATALOGUE = ("assumed", "datasheet", "the course")
#: What values of the motor are needed for.
_NEEDED = {"rotor_inertia": "J_load = J - J_motor needs it", "peak_current": "the run-up is limited by it"}


def lab_rig() -> Rig:
    """Rig of the simulated lab axis, `data/rigs/lab.toml`."""
    return load_rig(LAB)


def embedded() -> dict[str, Any]:
    """The same as tables, as TOML has them."""
    return read_toml(LAB, "a rig file")


def without_friction(rig: Rig) -> Rig:
    """The same simulated axis with neither viscous nor Coulomb friction; InputError where it cannot be simulated."""
    none = {"viscous_friction_coefficient": 0.0, "coulomb_friction": 0.0}
    return rig.model_copy(update={"simulation": rig.simulated.model_copy(update=none)})


def torque_constant(rig: Rig) -> TorqueConstant:
    """kT(Iq) of a rig; raises InputError where it gives none."""
    constant = rig.motor.torque_per_ampere
    if constant is None:
        raise InputError(f"{rig.source}: motor", "found no torque constant", "give the four datasheet values")
    return constant


def motor_value(rig: Rig, name: Literal["rotor_inertia", "peak_current"]) -> float:
    """J_motor - kg*m**2 - or Imax - A; raises InputError where the rig does not give it."""
    value = getattr(rig.motor, name)
    if value is None:
        raise InputError(f"{rig.source}: motor.{name}", "missing", _NEEDED[name])
    return value


def circuit(rig: Rig) -> Circuit:
    """The motor's winding as its peak curve at MAINS has it; raises InputError where it lacks what that needs."""
    return Circuit.from_motor(rig.motor, peak_curve(rig.motor, MAINS, rig.source), rig.source)


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
        return cls(given, given.get("motor", embedded()["motor"]).get("model"))

    def __call__(self, table: str, *keys: str) -> str:
        """Source of `[table] key`; of several keys those that they have."""
        return joined(*(self._source(table, key) for key in keys))

    def _source(self, table: str, key: str) -> str:
        if key in self.given.get(table, {}):
            return "rig file"
        entry = motor_sources(self.model) if table == "motor" and self.model is not None else {}
        if key in entry:
            text = entry[key][1]
            return next((word.removeprefix("the ") for word in _CATALOGUE if text.startswith(word)), "motor catalogue")
        return "embedded rig"


def joined(*sources: str) -> str:
    """Several sources of one number, each once."""
    return ", ".join(dict.fromkeys(sources))
