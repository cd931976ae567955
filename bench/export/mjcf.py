"""MJCF with a model: put onto a joint of another robot, or alone as a file with its joint.

Everything native to MuJoCo goes onto the joint, in the joint's own units. A model is on the motor's side of its gear, a
joint behind it. With i motor turns per turn of the joint, q_m = i*q:

    armature: J*i**2,  damping of order k: d_k*i**(k + 2),  frictionloss: K_0*i,  stiffness: c*i**2,  springref: q_0/i

What the model has as actuators (cogging, bristles, a constant torque) keeps the motor's units behind `gear="i"`. The
effects are asked for their parts by building the axis alone (`AxisModel.spec`); these are then moved over, so whatever
an effect adds comes along. A coupling of motor and load becomes a second joint of the link, behind the first one:
then the first joint is the motor's shaft, its armature the motor's inertia.

Ranges for domain randomisation state how far each value may lie from the one given: its interval at 95 %; where several
recordings determine it, the interval of one more, which includes how the axis differs from day to day.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import chain, count
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from bench.axis_kind import ARMATURE, COULOMB, VISCOUS
from bench.effects.effect import Effect
from bench.effects.mjcf import AXIS, DRIVE, LOAD, LOAD_TORQUE
from bench.effects.present import named
from bench.errors import InputError
from bench.export.actuator import buffered
from bench.files import read_bytes, read_text, whole
from bench.names import nearest, plain
from bench.plant.axis_model import NO_MASS, STICKING_IMPEDANCE, AxisModel, disk_inertia
from bench.plant.mjcf_file import read_mjcf
from bench.plant.model_file import StoredModel
from bench.plant.robot import Change, Counting, add_body, count_as, link_about_centre
from bench.plant.silenced import silenced
from bench.structured import json_text, parse_json

#: Folder of a robot's meshes and textures, next to its file.
ASSETS = "assets"
#: The body of a file that holds the joint alone.
BODY = "load"
#: The body of what another one carries.
PAYLOAD = "payload"
#: What makes an actuator what it is, but for its name, its joint and its gear.
ACTUATOR = ("gaintype", "biastype", "dyntype", "gainprm", "biasprm", "dynprm")
ACTUATOR += ("actdim", "actearly", "actlimited", "actrange")
ACTUATOR += ("ctrllimited", "ctrlrange", "ctrlspec", "forcelimited", "forcerange", "nsample", "interp", "delay")
#: Whether a joint of a type turns.
TURNS = {mujoco.mjtJoint.mjJNT_HINGE: True, mujoco.mjtJoint.mjJNT_SLIDE: False}


class ArmatureShare(StrEnum):
    """Of the model's inertia, what becomes a joint's armature."""

    MOTOR = "motor"
    ALL = "all"


@dataclass(frozen=True)
class Armature:
    """Inertia of a joint in addition to that of its links, on its side - kg*m**2 (kg) -, and what of the model's it
    is."""

    value: float
    origin: str


@dataclass(frozen=True)
class Carried:
    """What went onto a joint.

    Attributes:
        joint: its name.
        native: effects that MuJoCo now makes by itself.
        left: effects that are not in the MJCF, each with what does it instead.
        notes: what a user has to know of the rest.
    """

    joint: str
    native: tuple[str, ...]
    left: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]

    @property
    def lines(self) -> tuple[str, ...]:
        """All of it in sentences."""
        native = "no effect beyond friction and inertia is native"
        native = f"native: {', '.join(self.native)}" if self.native else native
        left = [f"not carried: {name} ({instead})" for name, instead in self.left]
        return f"{self.joint}: {native}", *left, *self.notes


@dataclass(frozen=True)
class PositionDrive:
    """A position controller of a joint.

    Attributes:
        kp, kd: its gains - N*m/rad (N/m), N*m*s/rad (N*s/m).
        delay: of its goal - s.
        limit: of its torque - N*m (N); infinite where none is known.
        lacking: what MuJoCo's position actuator does not have of it, in sentences.
    """

    kp: float
    kd: float
    delay: float
    limit: float
    lacking: tuple[str, ...] = ()


def robot_with(
    path: Path,
    models: Mapping[str, tuple[StoredModel, Armature | None]],
    out: Path,
    added: Sequence[Change] = (),
    kept: Sequence[str] = (),
    with_assets: bool = False,
    stand: bool = False,
    drives: Mapping[str, PositionDrive] | None = None,
) -> tuple[str, tuple[str, ...]]:
    """Text of a robot's MJCF with models at its joints, and what went onto each in sentences.

    Args:
        path: of the robot's MJCF.
        models: of joints by their names, each with its armature; None: that of the MJCF stays.
        out: where the text will stand, from where its meshes and textures are found.
        added: what the robot has in addition to its MJCF.
        kept: joints that were asked for and have no model.
        with_assets: whether meshes, height fields and textures are copied into ASSETS next to `out`.
        stand: whether a floating base is fixed.
        drives: position controllers of joints by their names, in the place of what drives them.

    Raises:
        InputError: the MJCF cannot be read, an asset cannot be written, or cannot have a model at its joint.
    """
    spec, notes = read_mjcf(path, stand)
    lines = [*notes, *(_beside(spec, one, path) for one in added)]
    for name, (stored, armature) in models.items():
        own = Armature(float(joint_of(spec, name, stored.model).armature), "the MJCF's own")
        lines += onto(spec, name, stored, armature or own).lines
    for name, drive in (drives or {}).items():
        lines += _driven(spec, name, drive)
    lines += [f"{name}: the MJCF's own armature, damping and frictionloss stay" for name in kept]
    compiled(spec)
    for folder in ("meshdir", "texturedir"):
        where = path.resolve().parent / (getattr(spec, folder) or "")
        if with_assets:
            _copy_assets(spec, folder, where, out.resolve().parent / ASSETS)
        setattr(spec, folder, ASSETS if with_assets else os.path.relpath(where, out.resolve().parent))
    spec.modelfiledir = str(out.resolve().parent)  # writing compiles once more
    return commented(spec, tuple(lines)), tuple(lines)


def _driven(spec: mujoco.MjSpec, name: str, drive: PositionDrive) -> list[str]:
    """Give a joint a position actuator, in the place of its own ones; in sentences."""
    own = [one for one in spec.actuators if one.target == name and one.trntype == mujoco.mjtTrn.mjTRN_JOINT]
    actuator = (
        own[0] if own else spec.add_actuator(name=f"{name} servo", target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    )
    for other in own[1:]:
        spec.delete(other)
    actuator.gear = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    actuator.set_to_position(drive.kp, kv=drive.kd)
    actuator.delay, actuator.nsample = drive.delay, buffered(drive.delay, spec.option.timestep)
    has = f"kp {drive.kp:.4g}, kv {drive.kd:.4g} and a delay of {drive.delay:.4g} s"
    if math.isfinite(drive.limit):
        actuator.forcerange, actuator.forcelimited = [-drive.limit, drive.limit], mujoco.mjtLimited.mjLIMITED_TRUE
        has = f"{has}, and a force limit of {drive.limit:.4g}"
    lines = [f"{name}: '{actuator.name}' has {has}"]
    return lines + [f"{name}: not carried: {text}" for text in drive.lacking]


def _copy_assets(spec: mujoco.MjSpec, kind: str, source: Path, target: Path) -> None:
    """Copy the files that a robot takes from a folder of a kind into another, where it then finds them."""
    named = [*spec.meshes, *spec.hfields, *spec.skins] if kind == "meshdir" else [*spec.textures]
    for asset in named:
        if asset.file:
            asset.file = _copied(source / asset.file, target)
        if kind == "texturedir":
            asset.cubefiles = [_copied(source / one, target) if one else one for one in asset.cubefiles]


def _copied(source: Path, target: Path) -> str:
    """Copy a file into a folder; returns its name there, a new one where another file has it."""
    content = read_bytes(source, "a robot's mesh or texture")
    names = chain([source.name], (f"{source.stem}_{k}{source.suffix}" for k in count(2)))
    place = next(one for name in names if not (one := target / name).exists() or read_bytes(one, "an asset") == content)
    with whole(place) as temporary:
        temporary.write_bytes(content)
    return place.name


def _beside(spec: mujoco.MjSpec, one: Change, path: Path) -> str:
    """Give a robot a payload, a joint the way its log counts, or a link's body the inertia that it has more about its
    joint's axis; in a sentence.

    A payload is a body of its own, which can be taken off again. A link's own inertia, about its centre, becomes larger
    in its proportions: no log of its one joint determines more, and any tensor that was one stays one.
    """
    if isinstance(one, Counting):
        count_as(spec, one)
        return f"{one.joint}: as its log counts, " + (
            "axis reversed" if one.reversed else f"zero moved by {one.zero:.4g}"
        )
    if not one.joint:
        add_body(spec, PAYLOAD, one, path)
        return f"{one.body}: with a payload of {one.mass:.4g} kg, the body '{PAYLOAD}'"
    model = compiled(spec)
    body, own = spec.joint(one.joint).parent, link_about_centre(model, one.joint)
    share = 1.0 + one.inertia / own
    if share <= 0.0:
        found = f"{own:.3g} kg*m**2 are less than {-one.inertia:.3g} to take"
        return f"{one.joint}: its link keeps the MJCF's inertia: {found}"
    at = model.joint(one.joint).bodyid[0]
    body.explicitinertial, body.mass, body.inertia = True, model.body_mass[at], share * model.body_inertia[at]
    body.ipos, body.iquat = model.body_ipos[at], model.body_iquat[at]
    body.fullinertia = [np.nan, 0.0, 0.0, 0.0, 0.0, 0.0]
    return f"{one.joint}: its link has {share:.4g} times the MJCF's inertia about its centre"


def single_joint(stored: StoredModel, name: str) -> tuple[str, Carried]:
    """Text of an MJCF with one body on a joint, whose values are a default class; it attaches to any body."""
    spec, model, mounting = mujoco.MjSpec(), stored.model, stored.mounting
    spec.modelname = name
    body = spec.worldbody.add_body(name=BODY)
    turns = model.parameters.kind.turns
    joint = body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE if turns else mujoco.mjtJoint.mjJNT_SLIDE)
    joint.axis = [1.0, 0.0, 0.0]
    armature = Armature(0.0, "as the motor's inertia is not known")  # the body has all of it
    if model.parameters.motor_inertia > 0.0 or mounting.link_inertia:
        armature = armature_of(stored)
    beyond = model.parameters.inertia * mounting.gear_ratio**2 - armature.value
    body.explicitinertial, body.ipos, body.iquat = True, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    body.mass = (mounting.load_mass or NO_MASS) if turns else beyond
    body.inertia = disk_inertia(beyond) if turns else [NO_MASS] * 3
    carried = onto(spec, name, stored, armature)
    kept = spec.add_default(re.sub(r"\W+", "_", stored.name).strip("_") or "axis", spec.default)
    for key in ("armature", "damping", "stiffness", "springref", "frictionloss", "solimp_friction", "solref_friction"):
        setattr(kept.joint, key, getattr(joint, key))
    joint.classname = kept
    compiled(spec)
    return commented(spec, (*carried.lines, _mass_of(body, stored))), carried


def onto(spec: mujoco.MjSpec, name: str, stored: StoredModel, armature: Armature | None = None) -> Carried:
    """Put a model onto a joint of a robot, which is changed, instead of the joint's own armature, damping and friction.

    Without an armature given it is that of the model. InputError where there is no such joint, one of another kind,
    a coupling on a body of several joints, or no armature remains.
    """
    joint, model, ratio = joint_of(spec, name, stored.model), stored.model, stored.mounting.gear_ratio
    links = link_inertia(spec, name)
    armature = armature or armature_of(stored)
    axis = model.spec(spec.option.timestep)
    alone = axis.joint(AXIS)
    if model.coupled:
        _couple(joint, axis, name, ratio)
    joint.armature = armature.value
    joint.damping = _scaled(alone.damping, ratio)
    own, added = float(joint.stiffness[0]), _scaled(alone.stiffness, ratio)
    joint.stiffness = np.asarray(joint.stiffness) + added
    if added[0]:  # two springs are one with a rest position between them
        reference = alone.springref / ratio * _angle(joint)
        joint.springref += (reference - joint.springref) * added[0] / (own + added[0])
    joint.frictionloss = alone.frictionloss * ratio
    joint.solimp_friction, joint.solref_friction = STICKING_IMPEDANCE, [2.0 * spec.option.timestep, 1.0]
    moving = [actuator.name or "an actuator without a name" for actuator in spec.actuators if actuator.target == name]
    geared: dict[str, Any] = {"target": name, "trntype": mujoco.mjtTrn.mjTRN_JOINT, "gear": [ratio, 0, 0, 0, 0, 0]}
    for actuator in axis.actuators:
        if actuator.name != DRIVE and (actuator.name != LOAD_TORQUE or actuator.biasprm[0] != 0.0):
            added = spec.add_actuator(name=f"{name} {actuator.name}", **geared)
            for key in ACTUATOR:
                setattr(added, key, getattr(actuator, key))
    driven = f"driven by {', '.join(moving)} as before"
    if not moving:
        spec.add_actuator(name=f"{name} motor", **geared)
        effort = model.parameters.kind.effort
        driven = f"the joint had no actuator: '{name} motor' takes the motor's {effort} as control"
    unit = model.parameters.kind.inertia_unit
    behind = f", behind a gear of {ratio:g}: all values are those of the joint" if ratio != 1.0 else ""
    inertia = (
        f"armature {armature.value:.4g} {unit}, {armature.origin}; the links beyond the joint have {links:.4g} {unit} "
        f"in the configuration of the MJCF{behind}"
    )
    couplings = joint.parent.joints[1:] if model.coupled else []
    between = [f"'{each.name}' lies between motor and link: '{name}' is the motor's" for each in couplings]
    return Carried(name, model.structure, stored.not_native, (inertia, driven, *between))


def _mass_of(body: mujoco.MjsBody, stored: StoredModel) -> str:
    """Where the mass of a body comes from."""
    if not stored.model.parameters.kind.turns:
        return f"mass {body.mass:.4g} kg: what of the model's is not the motor's"
    known = stored.mounting.load_mass is not None
    origin = "of the rig's disk" if known else "as a placeholder: give the body its own"
    return f"inertia of a flat disk; mass {body.mass:.4g} kg {origin}"


def commented(spec: mujoco.MjSpec, lines: tuple[str, ...]) -> str:
    """XML of a model with sentences before it, in which nothing ends the comment."""
    text = "\n     ".join(plain(line).replace("--", "- -") for line in lines)
    return f"<!-- {text} -->\n{spec.to_xml()}"


def joint_of(spec: mujoco.MjSpec, name: str, model: AxisModel) -> mujoco.MjsJoint:
    """The joint of a name, of the model's kind; InputError if there is none, or it turns where the model slides."""
    joint, names = spec.joint(name), [each.name for each in spec.joints if each.name]
    if joint is None:
        found = f"found no joint of that name{nearest(name, names)}" if name else "missing"
        raise InputError(
            f"--joint {name}".strip(), found, f"allowed: {', '.join(names) or 'an MJCF with a named joint'}"
        )
    if TURNS.get(joint.type) is not model.parameters.kind.turns:
        found = f"found a joint of type {joint.type.name.removeprefix('mjJNT_').lower()}"
        allowed = f"allowed: one that moves as the model does, {model.parameters.kind.name}"
        raise InputError(f"--joint {name}", found, allowed)
    return joint


def armature_of(stored: StoredModel, share: ArmatureShare | None = None) -> Armature:
    """Armature of the joint: a share of the model's inertia, or that of the model.

    InputError where the model has no inertia of the motor, or none remains without the links.
    """
    parameters, mounting = stored.model.parameters, stored.mounting
    if share is None:
        known = parameters.motor_inertia > 0.0 and not mounting.link_inertia
        share = ArmatureShare.MOTOR if stored.model.coupled or known else ArmatureShare.ALL
    if share is ArmatureShare.MOTOR:
        if parameters.motor_inertia <= 0.0:
            raise InputError(
                "--armature motor", "found a model without the motor's inertia", "allowed: `--armature all`"
            )
        return Armature(parameters.motor_inertia * mounting.gear_ratio**2, "the motor's")
    armature = parameters.inertia * mounting.gear_ratio**2 - mounting.link_inertia
    if armature <= 0.0:
        found = f"found an inertia of {parameters.inertia:.4g}, of which the links have {mounting.link_inertia:.4g}"
        raise InputError("the model's inertia", found, "allowed: more than the links have")
    beside = "all that moved but the links" if mounting.link_inertia else "all that moved in the recording"
    return Armature(armature, beside)


def link_inertia(spec: mujoco.MjSpec, name: str) -> float:
    """Inertia about a joint of all that it carries, its armature aside, in the configuration of the MJCF - kg*m**2
    (kg)."""
    model = compiled(spec)
    dof = model.joint(name).dofadr[0]
    return float(model.dof_M0[dof] - model.dof_armature[dof])


def compiled(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """The compiled model; InputError with MuJoCo's reason where it refuses it."""
    try:
        with silenced():
            return spec.compile()
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise InputError("the MJCF", f"MuJoCo refuses it: {reason}", "allowed: what MuJoCo compiles") from error


def _scaled(values: np.ndarray, ratio: float) -> np.ndarray:
    """Coefficients of a torque's powers of speed, or of angle, as they are on the joint's side of a gear."""
    return np.asarray(values) * ratio ** (2.0 + np.arange(len(values)))


def _angle(joint: mujoco.MjsJoint) -> float:
    """Of a joint, in the unit of its file over the SI's."""
    return float(np.rad2deg(1.0)) if joint.compiler.degree and joint.type == mujoco.mjtJoint.mjJNT_HINGE else 1.0


def _couple(joint: mujoco.MjsJoint, axis: mujoco.MjSpec, name: str, ratio: float) -> None:
    """Join motor and link by a second joint of the link, along the first: the sum of both is the link's position."""
    if len(joint.parent.joints) > 1:
        allowed = "allowed: a joint with a body of its own, as motor and load separate"
        raise InputError(f"--joint {name}", "found a body of several joints", allowed)
    for between in axis.body(LOAD).joints:
        added = joint.parent.add_joint(name=f"{name} {between.name}", type=joint.type, axis=joint.axis, pos=joint.pos)
        added.stiffness, added.damping = _scaled(between.stiffness, ratio), _scaled(between.damping, ratio)
        added.range, added.limited = np.asarray(between.range) / ratio * _angle(joint), between.limited
        added.solref_limit, added.solimp_limit = between.solref_limit, between.solimp_limit


SCHEMA = "bench.ranges/1"
#: What ranges are computed from.
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
        parameters = _ranges(content["parameters"], content.get("between") or {}, {})
        effects = [_effect(entry) for entry in content.get("effects", [])]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        found = f"found a damaged one ({type(error).__name__}: {error})"
        raise InputError(result, found, "allowed: as identify or diagnose wrote it") from error
    kept = {"parameters": parameters, "effects": effects, "joint": _joint(stored, parameters)}
    return json_text({"schema": SCHEMA, "name": stored.name, **kept}) + "\n"


def _ranges(
    parameters: Mapping[str, Any], between: Mapping[str, Any], lowest: Mapping[str, float]
) -> dict[str, dict[str, Any]]:
    """Value, range and origin of each quantity that has an interval, none below its lowest - its unit."""
    ranges = {}
    for name, table in parameters.items():
        if table["ci95"] is not None:
            low, high = (float(bound) for bound in table["ci95"])
            origin = "interval of 95 %"
            if between.get(name) is not None:
                ahead = [float(bound) for bound in between[name]["predictive95"]]
                low, high, origin = min(low, ahead[0]), max(high, ahead[1]), "expected of one more recording, at 95 %"
            value, low = float(table["value"]), max(low, lowest.get(name, -np.inf))
            ranges[name] = {"value": value, "low": low, "high": high, "unit": str(table["unit"]), "from": origin}
    return ranges


def _effect(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Ranges of an effect's quantities within their bounds."""
    effect: Effect = named(str(entry["name"]), "effects")
    lowest = {quantity.name: quantity.lower for quantity in (*effect.quantities, *effect.derived)}
    return {"name": effect.name, "parameters": _ranges(entry["parameters"], {}, lowest)}


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
