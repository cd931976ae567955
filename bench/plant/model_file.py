"""A model of an axis on disk: `model.toml` contains all of it, `model.xml` the part that MuJoCo has natively.

The model contains how it is mounted: what one on the motor's side needs to be put onto a joint of a robot.

schema = "bench.model/1"
name = "axis"
kind = "rotary"
misalignment = "1.27e-05 s"
peak_effort = "3.5 N*m"
effects = [{ name = "cogging_torque", amplitude = "0.05 N*m", harmonic = 6.0 }]
[parameters]
moment_of_inertia = "0.0022 kg*m**2"

`effects.toml` contains the same of every joint of a robot: `schema = "bench.effects/1"`, and a table `[joints.NAME]`
each.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from os.path import isdir
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import tomli_w

from bench.axis_kind import AxisKind, axis_kind
from bench.effects.mjcf import AXIS, LOAD, MOTOR
from bench.effects.present import Present, known_quantity, named, parse_value
from bench.effects.signals import Winding
from bench.errors import InputError
from bench.names import nearest
from bench.plant.axis_model import FLOOR, NO_MASS, AxisModel, AxisParameters, effect_values, parameter_quantities
from bench.rig.rig import Load, Rig
from bench.structured import read_toml

SCHEMA, OF_JOINTS = "bench.model/1", "bench.effects/1"
#: Table of the torque balance, and its key that states whether the parameters are its first coefficients.
BALANCE, SAME = "torque_balance", "same_parameters"
#: Share of the larger by which inertia and frictions may differ from the coefficients: as they are, and if refined.
EQUAL, REFINED = (1e-9, 1e-9, 1e-9), (0.5, 0.9, 0.9)
#: What makes an effect that is not native.
STEPPED, SEEN = "bench.Effects steps it", "it is in what sensors report, not in the motion"
#: How a simulation of `model.xml` steps the rest.
LOADED = 'effects = bench.Effects("model.toml"); effects.step(model, data)'
#: A value of a model is beyond what any axis has - SI.
LARGEST_VALUE = 1e12
#: Step that the exported MuJoCo model runs at - s.
TIMESTEP = 250e-6


@dataclass(frozen=True)
class Mounting:
    """Gear and load of an axis.

    Attributes:
        gear_ratio: motor turns per turn of the joint; 1 without a gear.
        load_mass: of the disk on the joint - kg; None where the rig does not state it.
        link_inertia: part of the model's inertia that is the links' of a robot, on the joint's side - kg*m**2 (kg).
        effort_limit: largest torque (force) that the rig or the robot's MJCF states, on the joint's side - N*m (N);
            None where neither does.
    """

    gear_ratio: float = 1.0
    load_mass: float | None = None
    link_inertia: float = 0.0
    effort_limit: float | None = None

    @classmethod
    def of(cls, rig: Rig) -> Mounting:
        """As a rig describes it."""
        load, motor, constant = rig.load or Load(), rig.motor, rig.motor.torque_per_ampere
        peak = motor.peak_torque
        if peak is None and constant is not None and motor.peak_current is not None:
            peak = float(constant.torque(np.asarray(motor.peak_current)))
        limits = [load.effort_limit, None if peak is None else peak * load.gear_ratio]
        limit = min((each for each in limits if each is not None), default=None)
        return cls(float(load.gear_ratio), load.disk_mass, load.link_inertia or 0.0, limit)


@dataclass(frozen=True)
class StoredModel:
    """A model with what is needed to compare it with a recording.

    Attributes:
        name: of the axis.
        model: the axis with its effects, on the motor's side.
        misalignment: by how much recordings of it report the effort late - s.
        mounting: how the axis sits in its machine; by default without gear and robot, under an unknown load.
        effort_unit: of its efforts where no rig gives them in N*m (N), e.g. A; inertia is then in A*s**2/rad.
    """

    name: str
    model: AxisModel
    misalignment: float = 0.0
    mounting: Mounting = Mounting()
    effort_unit: str = ""

    @property
    def unscaled(self) -> str:
        """That efforts are not in N*m (N), in a sentence; empty where they are."""
        if not self.effort_unit:
            return ""
        unit, kind = self.effort_unit, self.model.parameters.kind
        return f"Efforts are in {unit}, as no torque constant is known: 1 {kind.effort_unit} here is 1 {unit}."

    @property
    def not_native(self) -> tuple[tuple[str, str], ...]:
        """Effects that no MJCF has, each with what makes it."""
        model = self.model
        return tuple((p.name, STEPPED if p in model.stepped else SEEN) for p in model.effects if p not in model.native)


def model_xml(stored: StoredModel) -> str:
    """MJCF that MuJoCo opens without other files and attaches to any body; a comment lists what it lacks."""
    model, mounting = stored.model, stored.mounting
    spec = model.spec(TIMESTEP)
    spec.delete(spec.geom(FLOOR))
    mass = _set_masses(spec, model.parameters.kind, mounting)
    spec.compile()
    notes = [f"Axis at steps of {TIMESTEP:g} s, torque as input.", stored.unscaled, *lacking(stored), mass]
    if mounting.gear_ratio != 1.0:
        gear = f"a gear of {mounting.gear_ratio:g}"
        notes.append(f"All of it is on the motor's side of {gear}: the joint is the motor's shaft.")
    return "".join(f"<!-- {note} -->\n" for note in notes if note) + spec.to_xml()


def lacking(stored: StoredModel) -> list[str]:
    """What of a model its `model.xml` lacks, and how to simulate that too, in sentences; none where it has all."""
    by_kind = {kind: ", ".join(name for name, made in stored.not_native if made == kind) for kind in (STEPPED, SEEN)}
    sentences = []
    if names := by_kind[STEPPED]:
        stepped = f"{LOADED} instead of mujoco.mj_step(model, data)"
        if stored.mounting.gear_ratio != 1.0:  # where bench.Effects acts on the joint, and it is the motor's shaft
            stepped = "put the model onto a joint with bench export, and step it there with bench.Effects"
        sentences.append(f"model.xml lacks {names}. To simulate them too: {stepped}.")
    if names := by_kind[SEEN]:
        sentences.append(f"model.xml lacks {names}, which is in what sensors report, not in the motion.")
    return sentences


def model_toml(stored: StoredModel, further: Mapping[str, Any] | None = None) -> str:
    """The whole model as TOML, every value with its unit; `further` are tables of the same file, by name.

    A torque balance among them states whether its first coefficients are the parameters: values that simulation
    refined, or of a model with fewer effects, differ.
    """
    content = {"schema": SCHEMA, **_content(stored), **(further or {})}
    balance = content.get(BALANCE)
    if isinstance(balance, dict):
        content[BALANCE] = {SAME: not any(_differing(stored.model.parameters, balance, EQUAL)), **balance}
    note = f"# {stored.unscaled}\n" if stored.effort_unit else ""
    return note + tomli_w.dumps(content)


def joints_toml(models: Mapping[str, StoredModel]) -> str:
    """The models of a robot's joints, by name, as one TOML."""
    return tomli_w.dumps({"schema": OF_JOINTS, "joints": {name: _content(stored) for name, stored in models.items()}})


def _content(stored: StoredModel) -> dict[str, Any]:
    model, kind, mounting = stored.model, stored.model.parameters.kind, stored.mounting
    content: dict[str, Any] = {"kind": kind.name, "name": stored.name}
    if stored.effort_unit:
        content["effort_unit"] = stored.effort_unit
    content |= _texts({"misalignment": (stored.misalignment, "s")})
    if math.isfinite(model.peak_effort):
        content |= _texts({"peak_effort": (model.peak_effort, kind.effort_unit)})
    content["parameters"] = _texts(model.parameters.values)
    if model.winding is not None:
        units = _winding_units(kind)
        content["winding"] = _texts({key: (getattr(model.winding, key), unit) for key, unit in units.items()})
    if model.effects:
        content["effects"] = [{"name": one.name, **_texts(effect_values(one, kind))} for one in model.effects]
    if mounting != Mounting():
        own = {key: (getattr(mounting, key), unit) for key, unit in _mounted_units(kind).items()}
        content["mounting"] = _texts({key: pair for key, pair in own.items() if pair[0] != getattr(Mounting, key)})
    return content


def tables_toml(kind: AxisKind, tables: Mapping[str, Any]) -> str:
    """A `model.toml` of tables as they are, which is all there is where MuJoCo cannot have the model."""
    return tomli_w.dumps({"schema": SCHEMA, "kind": kind.name, **tables})


def load_model(path: str | Path, scaled: bool = False) -> StoredModel:
    """Read a `model.toml`.

    InputError: no such file, no TOML, another schema, an unknown or missing key, a value that is none or that no axis
    has, parameters that contradict the torque balance, or, where it has to be `scaled`, efforts not in N*m (N).
    """
    table = read_table(path, SCHEMA)
    stored, balance = _model(table, str(path)), table.get(BALANCE)
    if isinstance(balance, dict) and balance.get(SAME) is not False:
        for name, value, other in _differing(stored.model.parameters, balance, EQUAL if SAME in balance else REFINED):
            found = f"found {value:g}, and {other:g} among the coefficients of {BALANCE}"
            allowed = "allowed: one value in both, as bench diagnose RECORDING --rig RIG --out DIR writes them"
            raise InputError(f"{path}: parameters.{name}", found, allowed)
    if scaled and stored.effort_unit:
        wanted = f"allowed: {stored.model.parameters.kind.effort_unit}"
        instead = "set motor.torque_constant in the rig, and run `bench diagnose RECORDING --rig RIG --out DIR` again"
        raise InputError(f"{path}: effort_unit", f"found '{stored.effort_unit}'", f"{wanted}; {instead}")
    return stored


def _differing(
    parameters: AxisParameters, balance: Mapping[str, Any], shares: Sequence[float]
) -> Iterator[tuple[str, float, float]]:
    """Name, value and coefficient of each parameter that differs from the balance's; one below zero counts as zero."""
    coefficients = balance.get("coefficients")
    numbers = [one for one in coefficients if isinstance(one, int | float)] if isinstance(coefficients, list) else []
    if len(numbers) <= len(shares):
        return  # a misalignment follows: no balance
    for (name, (value, _)), number, share in zip(parameters.values.items(), numbers, shares, strict=False):
        other = max(float(number), 0.0)
        known = share == EQUAL[0] or (value > 0.0 and other > 0.0)
        if known and abs(value - other) > share * max(value, other):
            yield name, value, other


def load_joints(path: str | Path) -> dict[str, StoredModel]:
    """Models of a robot's joints, by name, from the `effects.toml` of `bench robot`; InputError as `load_model`."""
    joints = read_toml(path, "an effects.toml that bench robot wrote", OF_JOINTS).get("joints")
    if not isinstance(joints, dict) or not all(isinstance(one, dict) for one in joints.values()):
        raise InputError(f"{path}: joints", f"found {joints!r}", "allowed: a table for each joint")
    return {name: _model(one, f"{path}: joints.{name}") for name, one in joints.items()}


def load_models(path: str | Path, joints: Sequence[str] = (), scaled: bool = False) -> dict[str, StoredModel]:
    """Models by joint: that of a `model.toml` as a joint's, `axis` by default; all of an `effects.toml`, or some.

    InputError as `load_model`, or where there is no model of a joint, or one for several.
    """
    if read_table(path).get("schema") != OF_JOINTS:
        if len(joints) > 1:
            allowed = "allowed: one joint, or the effects.toml of bench robot, which has a model for each"
            raise InputError(path, f"found one model for {', '.join(joints)}", allowed)
        return {joints[0] if joints else AXIS: load_model(path, scaled)}
    models = load_joints(path)
    for joint in joints:
        if joint not in models:
            raise InputError(f"{path}: joints", f"found no '{joint}'", f"allowed: {', '.join(models)}")
    return {name: model for name, model in models.items() if not joints or name in joints}


def _model(table: Mapping[str, Any], path: str) -> StoredModel:
    kind = axis_kind(table.get("kind"), f"{path}: kind")
    quantities = parameter_quantities(kind)
    units = {quantity.name: quantity.unit for quantity in quantities.values()}
    values = _values(table.get("parameters"), units, f"{path}: parameters")
    for field, quantity in quantities.items():
        value = values[quantity.name]
        if not quantity.lower <= value <= quantity.upper or (field == "inertia" and value == 0.0):
            allowed = f"allowed: {'above zero' if quantity.lower == 0.0 else quantity.lower} to {quantity.upper:g}"
            raise InputError(f"{path}: parameters.{quantity.name}", f"found {value:g}", f"{allowed} {quantity.unit}")
    parameters = AxisParameters(**{field: values[quantity.name] for field, quantity in quantities.items()}, kind=kind)
    if parameters.motor_inertia > parameters.inertia:
        found = f"found {parameters.motor_inertia:g} in the motor, and {parameters.inertia:g} in all"
        raise InputError(f"{path}: parameters", found, "allowed: at most as much in the motor")
    winding = None
    if "winding" in table:
        winding = Winding(**_values(table["winding"], _winding_units(kind), f"{path}: winding"))
    peak = math.inf
    if "peak_effort" in table:
        peak = _value(table["peak_effort"], kind.effort_unit, f"{path}: peak_effort")
    effects = _effects(table.get("effects", []), kind, f"{path}: effects")
    misalignment = _value(table.get("misalignment", 0.0), "s", f"{path}: misalignment")
    model = AxisModel(parameters, effects, peak, winding)
    mounted = table.get("mounting", {})
    given = {key: unit for key, unit in _mounted_units(kind).items() if not isinstance(mounted, dict) or key in mounted}
    mounting = _values(mounted, given, f"{path}: mounting")
    for key, value in mounting.items():
        if value <= 0.0:
            raise InputError(f"{path}: mounting.{key}", f"found {value:g}", "allowed: above zero")
    unit = str(table.get("effort_unit", ""))
    return StoredModel(str(table.get("name", "axis")), model, misalignment, Mounting(**mounting), unit)


def read_table(path: str | Path, schema: str | None = None) -> dict[str, Any]:
    """The tables of a `model.toml`, or of that in a folder; InputError: unreadable, no TOML or of another schema."""
    path = Path(path) / "model.toml" if isdir(path) else path  # noqa: PTH112, of a name of any length
    return read_toml(path, "a model.toml that the bench wrote", schema)


def _values(table: object, units: Mapping[str, str], where: str) -> dict[str, float]:
    """All of the named values of a table, and nothing else."""
    if not isinstance(table, dict):
        raise InputError(where, "missing", "this table is required")
    for key in table:
        if key not in units:
            raise InputError(where, f"found '{key}'{nearest(key, list(units))}", f"allowed: {', '.join(units)}")
    for key in units:
        if key not in table:
            raise InputError(f"{where}.{key}", "missing", "this key is required")
    return {key: _value(table[key], unit, f"{where}.{key}") for key, unit in units.items()}


def _value(text: object, unit: str, where: str) -> float:
    value = parse_value(str(text), unit, where)
    if abs(value) > LARGEST_VALUE:
        raise InputError(where, f"found {value:g}, which no servo axis has", f"allowed: up to {LARGEST_VALUE:g} {unit}")
    return value


def _effects(entries: object, kind: AxisKind, where: str) -> tuple[Present, ...]:
    if not isinstance(entries, list):
        raise InputError(where, f"found {entries!r}", "allowed: a list of tables with a name")
    found = []
    for entry in entries:
        if not isinstance(entry, dict) or "name" not in entry:
            raise InputError(where, f"found {entry!r}", "allowed: tables with a name")
        effect = named(str(entry["name"]), where)
        units = {key: kind.unit(known_quantity(effect, key, where)) for key in entry if key != "name"}
        values = {key: _value(entry[key], unit, f"{where}: {effect.name}.{key}") for key, unit in units.items()}
        found.append(Present.of(effect.name, values, where))
    return tuple(found)


def _mounted_units(kind: AxisKind) -> dict[str, str]:
    units = {"gear_ratio": "dimensionless", "load_mass": "kg", "link_inertia": "kg*m**2"}
    return {**units, "effort_limit": kind.effort_unit}


def _winding_units(kind: AxisKind) -> dict[str, str]:
    names = [field.name for field in fields(Winding)]
    return dict(zip(names, (kind.translated("N*m/A"), "ohm", "H", kind.translated("V*s/rad")), strict=True))


def _texts(values: Mapping[str, tuple[float, str]]) -> dict[str, float | str]:
    """Values with their units, in all their digits."""
    pairs = ((key, float(value), unit) for key, (value, unit) in values.items())
    return {key: value if unit == "dimensionless" else f"{value!r} {unit}" for key, value, unit in pairs}


def _set_masses(spec: mujoco.MjSpec, kind: AxisKind, mounting: Mounting) -> str:
    """Set the known masses of the bodies of an axis, and negligible ones for the others; returns a sentence about them.

    About the shaft no mass is felt; it is where the axis itself is moved. What moves along a slide has its mass.
    """
    if not kind.turns:
        return "Masses are those of the model, parted between motor and load."
    spec.body(MOTOR).mass = NO_MASS
    known = mounting.load_mass
    spec.body(LOAD).mass = NO_MASS if known is None else known
    load = "the load's either" if known is None else f"the load's is the disk's, {known:.4g} kg"
    nothing = f"{NO_MASS:g} kg is used for what is not known"
    return f"Inertias are those of flat disks. The motor's mass is not known, {load}; {nothing}."
