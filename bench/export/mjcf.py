"""MJCF with a model as text: another robot with its joint, or a file of the joint alone."""

from __future__ import annotations

import os
import re
from pathlib import Path

import mujoco

from bench.errors import InputError
from bench.export.joint import Armature, Carried, Share, armature_of, compiled, onto
from bench.files import read_bytes, reason
from bench.names import plain
from bench.plant.model import NO_MASS, disk_inertia
from bench.plant.model_file import StoredModel

#: The body of a file that holds the joint alone.
BODY = "load"
#: Of a joint whose motor is not known: the body has all of the inertia.
UNKNOWN = Armature(0.0, "as the motor's inertia is not known")


def read_mjcf(path: Path) -> mujoco.MjSpec:
    """Editable model of an MJCF file.

    Raises:
        InputError: no such file, or MuJoCo does not read it.
    """
    read_bytes(path, "an MJCF file")
    try:
        return mujoco.MjSpec.from_file(str(path))
    except (ValueError, OSError) as error:
        message = " ".join(reason(error).split())
        raise InputError(path, f"MuJoCo does not read it: {message}", "allowed: MJCF") from error


def robot_with(path: Path, joint: str, stored: StoredModel, out: Path, share: Share | None) -> tuple[str, Carried]:
    """Text of a robot's MJCF with a model at a joint, and what went onto it.

    Args:
        path: of the robot's MJCF.
        joint: of it.
        stored: the model.
        out: where the text will stand, from where its meshes and textures are found.
        share: of the model's inertia that becomes the joint's armature; None: what the model tells.

    Raises:
        InputError: the MJCF cannot be read, or cannot have the model at this joint.
    """
    spec = read_mjcf(path)
    carried = onto(spec, joint, stored, armature_of(stored, share))
    compiled(spec)
    for folder in ("meshdir", "texturedir"):
        where = path.resolve().parent / (getattr(spec, folder) or "")
        setattr(spec, folder, os.path.relpath(where, out.resolve().parent))
    return commented(spec, carried.lines), carried


def joint_alone(stored: StoredModel, name: str) -> tuple[str, Carried]:
    """Text of an MJCF that holds one body on a joint, whose values are a default class; it attaches to any body."""
    spec, model, mounting = mujoco.MjSpec(), stored.model, stored.mounting
    spec.modelname = name
    body = spec.worldbody.add_body(name=BODY)
    turns = model.parameters.kind.turns
    joint = body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE if turns else mujoco.mjtJoint.mjJNT_SLIDE)
    joint.axis = [1.0, 0.0, 0.0]
    armature = UNKNOWN
    if model.parameters.motor_inertia > 0.0 or mounting.link_inertia:
        armature = armature_of(stored)
    beyond = model.parameters.inertia * mounting.gear_ratio**2 - armature.value
    body.explicitinertial, body.ipos, body.iquat = True, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    body.mass = (mounting.load_mass or NO_MASS) if turns else beyond
    body.inertia = disk_inertia(beyond) if turns else [NO_MASS] * 3
    carried = onto(spec, name, stored, armature)
    kept = spec.add_default(class_of(stored.name), spec.default)
    for key in ("armature", "damping", "stiffness", "frictionloss", "solimp_friction", "solref_friction"):
        setattr(kept.joint, key, getattr(joint, key))
    joint.classname = kept
    compiled(spec)
    return commented(spec, (*carried.lines, _mass_of(body, stored))), carried


def _mass_of(body: mujoco.MjsBody, stored: StoredModel) -> str:
    """Where the mass of a body comes from."""
    if not stored.model.parameters.kind.turns:
        return f"mass {body.mass:.4g} kg: what of the model's is not the motor's"
    known = stored.mounting.load_mass is not None
    origin = "of the rig's disk" if known else "stands in for one that is not known: give the body its own"
    return f"inertia of a flat disk; mass {body.mass:.4g} kg {origin}"


def class_of(name: str) -> str:
    """A name as that of a default class: letters, digits and _."""
    return re.sub(r"\W+", "_", name).strip("_") or "axis"


def commented(spec: mujoco.MjSpec, lines: tuple[str, ...]) -> str:
    """XML of a model with sentences before it, in which nothing ends the comment."""
    text = "\n     ".join(plain(line).replace("--", "- -") for line in lines)
    return f"<!-- {text} -->\n{spec.to_xml()}"
