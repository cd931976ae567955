"""The baseline on disk: TOML for version control, readable in a diff.

schema = "bench.baseline/1"
source = "recordings"
names = true
verdict = "explained"
[provenance]
version = "0.1.0"
[quantities.moment_of_inertia]
value = "0.00131 kg*m**2"
std_error = "1.2e-06 kg*m**2"
recordings = 1
spread = "not told by fewer than two recordings"
[[effects]]
name = "cogging_torque"
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import tomli_w

from bench.baseline.response import INSTANTS, Response
from bench.baseline.state import Gap, NamedHere, Shows, State
from bench.comparison.difference import Measured
from bench.effects.present import named
from bench.errors import InputError
from bench.files import write_text
from bench.structured import read_toml

SCHEMA = "bench.baseline/1"
HEAD = "# What `bench check` holds the axis against. `bench check --update` writes it anew: look at the difference.\n"
#: Written instead of an unknown spread.
NO_SPREAD = "not told by fewer than two recordings"
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?: (.+))?")
_ALLOWED = "allowed: as bench check --update wrote it"


def write_baseline(path: str | Path, state: State) -> None:
    """Write a state, whole or not at all.

    Raises:
        InputError: the place cannot be written to.
    """
    write_text(path, HEAD + tomli_w.dumps(_table(state)))


def _table(state: State) -> dict[str, Any]:
    content: dict[str, Any] = {"schema": SCHEMA, "source": state.source, "names": state.names}
    if state.verdict:
        content["verdict"] = state.verdict
    content["provenance"] = _without_none(state.provenance)
    content["quantities"] = {name: _measured(found) for name, found in state.quantities.items()}
    if state.gaps:
        content["gap"] = {
            name: {"after": _text(gap.after, gap.unit), "noise_floor": _text(gap.noise_floor, gap.unit)}
            for name, gap in state.gaps.items()
        }
    if state.shows is not None:
        unit = state.gaps["torque"].unit
        content["shows"] = {"torque": _text(state.shows.torque, unit), "left": _text(state.shows.left, unit)}
    if state.conditions:
        content["conditions"] = {key: _text(one.value, one.unit) for key, one in state.conditions.items()}
    if state.rig:
        content["rig"] = dict(state.rig)
    if state.response is not None:
        content["response"] = asdict(state.response)
    content["effects"] = [_effect(effect) for effect in state.effects]
    return content


def _measured(found: Measured) -> dict[str, Any]:
    """A quantity; one that is exact has a value alone."""
    table: dict[str, Any] = {"value": _text(found.value, found.unit)}
    if not found.std_error:
        return table
    table["std_error"] = _text(found.std_error, found.unit)
    if math.isfinite(found.degrees):
        table["degrees"] = round(found.degrees, 1)
    table["recordings"] = found.recordings
    table["spread"] = NO_SPREAD if found.spread is None else _text(found.spread, found.unit)
    return table


def _effect(effect: NamedHere) -> dict[str, Any]:
    table: dict[str, Any] = {"name": effect.name, "ambiguous_with": list(effect.ambiguous_with)}
    if effect.shape is not None:
        table |= {"shape": list(effect.shape), "on_load": effect.on_load}
    if effect.torque is not None:
        table |= {"torque": _measured(effect.torque), "gain": effect.gain}
    return table | {"quantities": {key: _measured(found) for key, found in effect.quantities.items()}}


def _text(value: float, unit: str) -> str:
    """A number in as many digits as any comparison needs, with its unit."""
    return f"{value:.9g} {unit}" if unit != "dimensionless" else f"{value:.9g}"


def _without_none(content: Any) -> Any:  # noqa: ANN401 - TOML has no null
    if isinstance(content, Mapping):
        return {key: _without_none(value) for key, value in content.items() if value is not None}
    return [_without_none(value) for value in content] if isinstance(content, list | tuple) else content


def read_baseline(path: str | Path) -> State:
    """The state that a file holds.

    Raises:
        InputError: no such file, no TOML, another schema, or a key that is missing or wrong.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(path, "no such baseline", "run the same command with --update to make one of this state")
    table = read_toml(path, "a baseline that bench check wrote")
    if table.get("schema") != SCHEMA:
        raise InputError(f"{path}: schema", f"found {table.get('schema')!r}", f"allowed: '{SCHEMA}'")
    return _Reader(str(path)).state(table)


def require_source(baseline: State, source: str, where: object = "baseline") -> None:
    """InputError where a baseline is of recordings and a model is checked, or the other way round."""
    if baseline.source != source:
        raise InputError(where, f"found that of {baseline.source}", f"allowed: one of {source}; --update makes one")


class _Reader:
    """Reads tables of a file; every error names file and key.

    Args:
        source: of the file.
    """

    def __init__(self, source: str) -> None:
        self.source = source

    def state(self, table: Mapping[str, Any]) -> State:
        """The whole file."""
        quantities = self.tables(table, "quantities")
        gaps, shows = self.tables(table, "gap"), self.table(table, "shows")
        return State(
            source=self.one(table, "source", str),
            names=self.one(table, "names", bool),
            quantities={name: self.measured(found, f"quantities.{name}") for name, found in quantities.items()},
            effects=tuple(self.effect(entry, f"effects[{k}]") for k, entry in enumerate(table.get("effects", []))),
            verdict=str(table.get("verdict", "")),
            gaps={name: self.gap(found, f"gap.{name}") for name, found in gaps.items()},
            shows=self.shows(shows) if shows else None,
            conditions=self.exact(self.table(table, "conditions"), "conditions"),
            rig={str(key): str(value) for key, value in self.table(table, "rig").items()},
            provenance=self.table(table, "provenance"),
            response=self.response(self.table(table, "response")) if "response" in table else None,
        )

    def shows(self, table: Mapping[str, Any]) -> Shows:
        """What the recording would have shown."""
        return Shows(self.number(table, "torque", "shows")[0], self.number(table, "left", "shows")[0])

    def response(self, table: Mapping[str, Any]) -> Response:
        """The run of a model."""
        torque = self.one(table, "torque", list, "response")
        laid_out = [self.one(table, key, float, "response") for key in ("inertia", "acceleration")]
        if len(torque) != INSTANTS or not all(isinstance(one, float) and math.isfinite(one) for one in torque):
            raise InputError(f"{self.source}: response.torque", f"found {torque!r}", f"allowed: {INSTANTS} numbers")
        if not all(0.0 < one < math.inf for one in laid_out):
            raise InputError(f"{self.source}: response", f"found {laid_out!r}", "allowed: numbers above zero")
        return Response(laid_out[0], laid_out[1], tuple(torque))

    def table(self, table: Mapping[str, Any], key: str) -> Mapping[str, Any]:
        """A table of a table, {} where there is none."""
        found = table.get(key, {})
        if not isinstance(found, dict):
            raise InputError(f"{self.source}: {key}", f"found {found!r}", "allowed: a table")
        return found

    def tables(self, table: Mapping[str, Any], key: str) -> Mapping[str, Mapping[str, Any]]:
        """A table of tables."""
        found = self.table(table, key)
        return {name: self.table(found, name) for name in found}

    def one(self, table: Mapping[str, Any], key: str, kind: type, where: str = "") -> Any:  # noqa: ANN401
        """A value of a kind that has to be there."""
        place = f"{self.source}: {where}{'.' if where else ''}{key}"
        if key not in table:
            raise InputError(place, "missing", _ALLOWED)
        if not isinstance(table[key], kind):
            raise InputError(place, f"found {table[key]!r}", _ALLOWED)
        return table[key]

    def number(self, table: Mapping[str, Any], key: str, where: str) -> tuple[float, str]:
        """A number with its unit."""
        text = self.one(table, key, str, where)
        match = _NUMBER.fullmatch(text)
        if match is None or not math.isfinite(float(match[1])):
            raise InputError(f"{self.source}: {where}.{key}", f"found {text!r}", "allowed: a number and its unit")
        return float(match[1]), match[2] or "dimensionless"

    def measured(self, table: Mapping[str, Any], where: str) -> Measured:
        """A quantity."""
        value, unit = self.number(table, "value", where)
        if "std_error" not in table:
            return Measured(value, unit, 0.0)
        error, _ = self.number(table, "std_error", where)
        degrees, count = table.get("degrees", math.inf), self.one(table, "recordings", int, where)
        spread = None if table.get("spread", NO_SPREAD) == NO_SPREAD else self.number(table, "spread", where)[0]
        if not (isinstance(degrees, float | int) and degrees > 0.0 and count > 0 and error >= 0.0):
            raise InputError(f"{self.source}: {where}", "found an error or a count below zero", _ALLOWED)
        return Measured(value, unit, error, float(degrees), count, spread)

    def gap(self, table: Mapping[str, Any], where: str) -> Gap:
        """A gap."""
        (after, unit), (floor, _) = self.number(table, "after", where), self.number(table, "noise_floor", where)
        return Gap(after, floor, unit)

    def exact(self, table: Mapping[str, Any], where: str) -> dict[str, Measured]:
        """Numbers without errors."""
        found = {key: self.number(table, key, where) for key in table}
        return {key: Measured(value, unit, 0.0) for key, (value, unit) in found.items()}

    def effect(self, table: object, where: str) -> NamedHere:
        """An effect."""
        if not isinstance(table, dict):
            raise InputError(f"{self.source}: {where}", f"found {table!r}", _ALLOWED)
        effect = named(self.one(table, "name", str, where), f"{self.source}: {where}.name")
        shape = table.get("shape")
        if shape is not None and not (isinstance(shape, list) and len(shape) == len(effect.shapes)):
            raise InputError(
                f"{self.source}: {where}.shape", f"found {shape!r}", f"allowed: {len(effect.shapes)} numbers"
            )
        if shape is not None and not all(isinstance(one, float | int) and math.isfinite(one) for one in shape):
            raise InputError(f"{self.source}: {where}.shape", f"found {shape!r}", "allowed: finite numbers")
        quantities = self.tables(table, "quantities")
        return NamedHere(
            effect=effect,
            quantities={key: self.measured(one, f"{where}.quantities.{key}") for key, one in quantities.items()},
            shape=None if shape is None else tuple(map(float, shape)),
            on_load=bool(table.get("on_load", False)),
            torque=self.measured(table["torque"], f"{where}.torque") if "torque" in table else None,
            ambiguous_with=tuple(map(str, table.get("ambiguous_with", []))),
            gain=float(table.get("gain", math.nan)),
        )
