"""An MJCF that a person gives: every file that it names is known as read, and it is first compiled where that can be
stopped.

MuJoCo opens by itself what an MJCF includes and shows, waits for a pipe among it, and ends its process where a replica
or a height field takes more memory than there is.
"""

from __future__ import annotations

import html
import re
from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np

from bench.errors import InputError
from bench.files import read_bytes, read_text
from bench.jobs.process import Failure, Limits, WorkerProcess, watched
from bench.plant.silenced import silenced

#: Within which a robot compiles; one of a hundred meshes takes seconds.
LIMITS = Limits(deadline=60.0)
_FILE, _FOLDER = (re.compile(rf"""\b{name}\s*=\s*(?:"([^"]*)"|'([^']*)')""") for name in (r"file\w*", r"\w+dir"))
#: An attribute of numbers that are none: to MuJoCo a mass of nan is one that was not given.
_NAN = re.compile(r"""\b(\w+)\s*=\s*["']([\s\d.eE+-]*\bnan\b[^"'<]*)["']""", re.IGNORECASE)
#: Fields of a compiled model that are finite in any that means something.
FINITE = ("qpos0", "body_mass", "body_inertia", "dof_armature", "dof_damping", "dof_frictionloss", "jnt_stiffness")


def read_mjcf(path: Path, stand: bool = False) -> tuple[mujoco.MjSpec, tuple[str, ...]]:
    """The part of an MJCF or URDF that MuJoCo compiles, as `read_spec`; the files that it names are read with it.

    With `stand` a floating base is fixed where the file has it. InputError where one of the files is not a regular
    file, or MuJoCo does not make a model of it within LIMITS.
    """
    _read_all(path)
    fault = _outcome(str(path), path.stat().st_mtime_ns, stand)
    if isinstance(fault, Failure):
        raise InputError(path, f"MuJoCo makes no model of it: {fault.reason}", "allowed: MJCF that it compiles")
    if fault:
        raise InputError(path, f"MuJoCo refuses it: {fault}", "allowed: MJCF")
    with silenced():
        return read_spec(str(path), stand)


@lru_cache(maxsize=1)
def _outcome(path: str, _changed: int, stand: bool) -> str | Failure:
    """Printed by the process, once of a robot of many joints."""
    if watched():
        return _fault((path, stand))
    with WorkerProcess(_fault, LIMITS) as process:
        return process.do((path, stand))


def _fault(asked: tuple[str, bool]) -> str:
    """Why an MJCF is none; empty if it is one."""
    with silenced():
        try:
            model = read_spec(*asked)[0].compile()
            mujoco.mj_forward(model, mujoco.MjData(model))
        except (ValueError, OSError, RuntimeError, mujoco.FatalError, UnicodeError) as error:
            return " ".join(str(error).split())
    wrong = [field for field in FINITE if not np.isfinite(getattr(model, field)).all()]
    return f"{wrong[0]} is not finite" if wrong else ""


def read_spec(path: str, stand: bool = False) -> tuple[mujoco.MjSpec, tuple[str, ...]]:
    """The contents of an MJCF or URDF, without meshes that are not there, and these in words.

    With `stand` also without free joints, and then without keyframes, which give these a pose. Raises ValueError as
    MuJoCo does, and where the inertia of a body that moves is computed from such a mesh.
    """
    spec, notes = mujoco.MjSpec.from_file(path), []
    free = [joint for joint in spec.joints if joint.type == mujoco.mjtJoint.mjJNT_FREE] if stand else []
    if free:
        bodies = ", ".join(f"'{joint.parent.name}'" for joint in free)
        notes.append(f"{bodies} is fixed as on a stand" + (", keyframes are omitted" if spec.keys else ""))
    for element in (*free, *(spec.keys if free else ())):
        spec.delete(element)
    folder = Path(path).parent / spec.meshdir
    missing = {mesh.name: mesh for mesh in spec.meshes if mesh.file and not (folder / mesh.file).is_file()}
    for geom in [one for one in spec.geoms if one.meshname in missing]:
        if not geom.parent.explicitinertial and _moves(geom.parent):
            raise ValueError(
                f"mesh '{geom.meshname}' does not exist, and the inertia of '{geom.parent.name}' is computed from it"
            )
        spec.delete(geom)
    for mesh in missing.values():
        spec.delete(mesh)
    note = f"meshes that do not exist are omitted from {Path(path).name}: {', '.join(sorted(missing))}"
    return spec, (*notes, *([note] if missing else []))


def _moves(body: mujoco.MjsBody) -> bool:
    """Whether a body has a joint, or is carried by one that has."""
    while body is not None and body.name != "world":
        if body.joints:
            return True
        body = body.parent
    return False


def _read_all(path: Path) -> None:
    """Read an MJCF and, where they are, the files that it and those name; each folder that is named may be theirs."""
    folders, waiting, seen = [path.parent], [path], set[Path]()
    while waiting:
        file = waiting.pop()
        text = _text(file)
        named = {Path(html.unescape(double or single)) for double, single in _FILE.findall(text)}
        folders += [file.parent, *(path.parent / html.unescape(one or two) for one, two in _FOLDER.findall(text))]
        found = {folder / name for folder in dict.fromkeys(folders) for name in named}
        seen.add(file)
        waiting += [one for one in found - seen if _is_there(one)]
        seen |= found


def _text(path: Path) -> str:
    """Of an MJCF; empty of a mesh or a picture, which names nothing."""
    if not read_bytes(path, "an MJCF file").lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        return ""
    text = read_text(path, "an MJCF file")
    if wrong := _NAN.search(text):
        raise InputError(f"{path}: {wrong[1]}", f"found {wrong[2]}", "allowed: numbers")
    return text


def _is_there(path: Path) -> bool:
    try:
        return path.exists() and not path.is_dir()
    except (OSError, ValueError):
        return False
