"""Ranges for domain randomisation: how far each value of a model may lie from the one told, as JSON.

A value's range is its interval at 95 %; where several recordings tell it, the interval of what one more may tell, which
holds what the axis differs by from day to day. Physics bounds both. `joint` has the same in MuJoCo's words, on the
joint's side of the gear.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bench.axis_kind import ARMATURE, COULOMB, VISCOUS
from bench.effects.effect import Effect
from bench.effects.present import named
from bench.errors import InputError
from bench.export.mjcf import ArmatureShare, armature_of
from bench.files import read_text
from bench.plant.model_file import StoredModel
from bench.structured import json_text, parse_json

SCHEMA = "bench.ranges/1"
#: What ranges are made of.
SOURCES = ("bench.identify/1", "bench.diagnose/1")


def ranges_json(stored: StoredModel, result: Path) -> str:
    """Ranges of a model's values, from the JSON that `identify` or `diagnose` wrote of the same axis.

    InputError where that cannot be read, or is none of these.
    """
    content = parse_json(read_text(result, "a JSON that identify or diagnose wrote"), result)
    if not isinstance(content, dict) or content.get("schema") not in SOURCES:
        found = content.get("schema") if isinstance(content, dict) else type(content).__name__
        raise InputError(f"{result}: schema", f"found {found!r}", f"allowed: {', '.join(SOURCES)}")
    try:
        between, stated = content.get("between") or {}, _with_interval(content["parameters"])
        parameters = {name: _range(table, between.get(name)) for name, table in stated.items()}
        effects = [_effect(entry) for entry in content.get("effects", [])]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        found = f"found a damaged one ({type(error).__name__}: {error})"
        raise InputError(result, found, "allowed: as identify or diagnose wrote it") from error
    kept = {"parameters": parameters, "effects": effects, "joint": _joint(stored, parameters)}
    return json_text({"schema": SCHEMA, "name": stored.name, **kept}) + "\n"


def _with_interval(parameters: Mapping[str, Any]) -> dict[str, Any]:
    return {name: table for name, table in parameters.items() if table["ci95"] is not None}


def _range(table: Mapping[str, Any], between: Mapping[str, Any] | None, lower: float = float("-inf")) -> dict[str, Any]:
    """Value, range and origin of a quantity - its unit."""
    low, high = (float(bound) for bound in table["ci95"])
    origin = "interval of 95 %"
    if between is not None:
        ahead = [float(bound) for bound in between["predictive95"]]
        low, high, origin = min(low, ahead[0]), max(high, ahead[1]), "what one recording more may tell, at 95 %"
    value = float(table["value"])
    return {"value": value, "low": max(low, lower), "high": high, "unit": str(table["unit"]), "from": origin}


def _effect(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Ranges of an effect's quantities within their bounds."""
    effect: Effect = named(str(entry["name"]), "effects")
    bounds = {quantity.name: quantity.lower for quantity in (*effect.quantities, *effect.derived)}
    known = _with_interval(entry["parameters"])
    ranges = {key: _range(table, None, bounds.get(key, float("-inf"))) for key, table in known.items()}
    return {"name": effect.name, "parameters": ranges}


def _joint(stored: StoredModel, parameters: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Ranges of a MuJoCo joint's armature, damping and friction loss, on its side of the gear."""
    kind, ratio = stored.model.parameters.kind, stored.mounting.gear_ratio
    scaled = {"damping": (kind.parameter(VISCOUS), ratio**2), "frictionloss": (kind.parameter(COULOMB), ratio)}
    if stored.mounting.link_inertia:
        scaled[ARMATURE] = ARMATURE, 1.0
    elif not stored.model.parameters.motor_inertia:
        scaled[ARMATURE] = kind.inertia, ratio**2
    found = {
        field: {bound: max(parameters[name][bound] * factor, 0.0) for bound in ("value", "low", "high")}
        for field, (name, factor) in scaled.items()
        if name in parameters
    }
    if ARMATURE not in found:
        value = armature_of(stored, ArmatureShare.MOTOR).value if stored.model.parameters.motor_inertia else 0.0
        found[ARMATURE] = {"value": value, "low": value, "high": value}
    return found
