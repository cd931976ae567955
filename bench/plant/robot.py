"""The rest of a robot, as a joint feels it along a log: gravity, the links' inertia, what other joints do to it.

By MuJoCo's inverse dynamics of the user's own MJCF, the joint's armature, damping and friction set to zero. With the
robot's mass matrix M and p = row of the joint of M*w,

    M_rest = dp/dt + r,  r = bias - passive - (dM/dt*w),

so that no acceleration is needed from the log (`bench.trace.trace`). The joint's own inertia at the
configuration of the MJCF is left to the balance, together with the armature: noise of its speed is then weighted
correctly.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import mujoco
import numpy as np
from mujoco.batch import Batch

from bench.arrays import Array
from bench.errors import InputError
from bench.files import read_bytes
from bench.names import nearest
from bench.rig.load import Load
from bench.rig.rig import Rig
from bench.trace.channel import Recording
from bench.trace.choose import GivenOptions
from bench.trace.read import read_recording
from bench.trace.time_base import interpolate
from bench.trace.trace import Trace, assemble, with_known

#: Poses evaluated at once, which bounds memory.
TOGETHER = 4096
#: Time over which the change of the mass matrix along the motion is taken, to both sides - s.
ASIDE = 1e-4
#: Joints of one coordinate.
SIMPLE = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
#: What inverse dynamics leaves out: what is no property of the links.
DISABLED = (
    mujoco.mjtDisableBit.mjDSBL_CONSTRAINT,
    mujoco.mjtDisableBit.mjDSBL_CONTACT,
    mujoco.mjtDisableBit.mjDSBL_ACTUATION,
    mujoco.mjtDisableBit.mjDSBL_SENSOR,
)


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot around one of its joints: a model without armature, damping and friction of it, and its file."""

    model: mujoco.MjModel
    joint: str
    source: str

    @classmethod
    def of(cls, path: Path, joint: str) -> Robot:
        """From an MJCF file; InputError if there is no such file or joint, or a joint of more than one coordinate."""
        read_bytes(path, "an MJCF file")
        try:
            model = mujoco.MjModel.from_xml_path(str(path))
        except ValueError as error:
            raise InputError(path, f"MuJoCo refuses it: {' '.join(str(error).split())}", "allowed: MJCF") from error
        names = [model.joint(k).name for k in range(model.njnt)]
        if joint not in names:
            found = f"found no joint '{joint}'{nearest(joint, names)}"
            raise InputError(path, found, f"allowed: {', '.join(filter(None, names)) or 'a joint with a name'}")
        for k, name in enumerate(names):
            if model.jnt_type[k] not in [int(kind) for kind in SIMPLE]:
                raise InputError(f"{path}: joint '{name}'", "found a free or ball joint", "allowed: hinges and slides")
        dof = model.joint(joint).dofadr[0]
        for field in (model.dof_armature, model.dof_damping, model.dof_dampingpoly, model.dof_frictionloss):
            field[dof] = 0.0
        for flag in DISABLED:
            model.opt.disableflags |= int(flag)
        return cls(model, joint, str(path))

    @property
    def units(self) -> dict[str, str]:
        """Names of the other joints with the units of their positions."""
        turning = int(mujoco.mjtJoint.mjJNT_HINGE)
        joints = {self.model.joint(k).name: kind for k, kind in enumerate(self.model.jnt_type)}
        return {name: "rad" if kind == turning else "m" for name, kind in joints.items() if name != self.joint}

    @property
    def turns(self) -> bool:
        """Whether the joint turns rather than slides."""
        return bool(self.model.jnt_type[self.model.joint(self.joint).id] == int(mujoco.mjtJoint.mjJNT_HINGE))

    @cached_property
    def inertia(self) -> float:
        """Of all that the joint carries, where the MJCF stands - kg*m**2 (kg)."""
        unit = np.zeros((1, self.model.nv))
        unit[0, self.model.joint(self.joint).dofadr[0]] = 1.0
        return float(self._momentum(self.model.qpos0[None], unit)[0])

    def rest(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """What the links ask of the joint beside its own inertia: r - N*m (N) - and p - N*m*s (N*s) -, (n,) each.

        Of positions and velocities of all joints in the MJCF's order - rad (m), rad/s (m/s) - (n, joints).
        """
        dof = int(self.model.joint(self.joint).dofadr[0])
        torque, momentum = np.empty(len(position)), np.empty(len(position))
        for start in range(0, len(position), TOGETHER):
            part = slice(start, start + TOGETHER)
            q, w = position[part], velocity[part]
            ahead, behind = (self._momentum(q + side * ASIDE * w, w) for side in (1.0, -1.0))
            turning = (ahead - behind) / (2.0 * ASIDE)
            bias, passive = self._evaluated(q, w, "qfrc_bias", "qfrc_passive")
            torque[part] = bias[:, dof] - passive[:, dof] - turning
            momentum[part] = self._momentum(q, w) - self.inertia * w[:, dof]
        return torque, momentum

    def _momentum(self, position: Array, velocity: Array) -> Array:
        """Of the joint, (n,): its row of the mass matrix times the velocities; the matrix comes as its lower half."""
        model, dof = self.model, int(self.model.joint(self.joint).dofadr[0])
        (matrix,) = self._evaluated(position, np.zeros_like(velocity), "M")
        row = np.repeat(np.arange(model.nv), model.M_rownnz)
        column = model.M_colind
        found = np.zeros(len(position))
        for k in np.flatnonzero((row == dof) | (column == dof)):
            found += matrix[:, k] * velocity[:, column[k] if row[k] == dof else row[k]]
        return found

    def _evaluated(self, position: Array, velocity: Array, *fields: str) -> list[Array]:
        """Fields of MuJoCo's data at poses, (n, ...) each."""
        batch = Batch(self.model, len(position))
        bound = [batch.bind(field) for field in fields]
        batch.bind("qpos")[:], batch.bind("qvel")[:] = position, velocity
        batch.forward()
        return [np.array(values) for values in bound]


def rig_within(rig: Rig, robot: Robot) -> Rig:
    """The rig of a joint whose links the robot's model knows."""
    load = (rig.load or Load()).model_copy(update={"link_inertia": robot.inertia})
    return rig.model_copy(update={"load": load})


def read_log(path: Path, rig: Rig, robot: Robot, stated: Mapping[str, float]) -> Trace:
    """A log of a joint with the torque that the rest of the robot asks of it.

    The log holds, beside the joint's own signals, `NAME.position` of every other joint and `NAME.velocity` where it is
    recorded; joints that it does not hold stand where they are `stated` to - rad (m). The rig's gear lies between the
    log's position and the joint's. InputError where the log cannot be read, or a joint is neither in it nor stated.
    """
    recording = read_recording(path)
    own = rig.on_axis(robot.joint) if _holds(recording, robot.joint) and rig.trace.axis is None else rig
    trace, ratio = assemble(recording, own.trace), (rig.load or Load()).gear_ratio
    position, velocity = np.empty((2, len(trace), robot.model.nv))
    for k in range(robot.model.nv):
        name = robot.model.joint(k).name
        if name == robot.joint:
            position[:, k], velocity[:, k] = (values / ratio for values in _motion(trace, trace))
        elif _holds(recording, name):
            position[:, k], velocity[:, k] = _motion(assemble(recording, GivenOptions(axis=name)), trace)
        elif name in stated:
            position[:, k], velocity[:, k] = stated[name], 0.0
        else:
            allowed = f"allowed: a column '{name}.position [rad]', or --at {name}=0"
            raise InputError(f"{path}: joint '{name}'", "is neither in the log nor stated", allowed)
    torque, momentum = robot.rest(position, velocity)
    return with_known(trace, torque / ratio, momentum / ratio, rig.effort_unit)


def _holds(recording: Recording, name: str) -> bool:
    """Whether a log has signals of a joint."""
    return any(name == one.axis or name.lower() in one.name.lower().split(".") for one in recording.channels)


def _motion(trace: Trace, at: Trace) -> tuple[Array, Array]:
    """Position and speed of a joint - rad (m), rad/s (m/s) - at the times of another trace (n,)."""
    position = trace["position"]
    velocity = np.empty_like(position)
    for part in trace.segments:
        alone = part.stop - part.start < 2
        velocity[part] = 0.0 if alone else np.gradient(position[part], trace.sample_period)
    if "velocity" in trace:
        velocity = trace["velocity"]
    if np.array_equal(trace.time, at.time):
        return position, velocity
    return interpolate(at.time, trace.time, position), interpolate(at.time, trace.time, velocity)
