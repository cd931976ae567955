"""A joint of an MJCF whose servo is fitted: its log, the torque of its links, and the actuator that the MJCF has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from bench.errors import InputError
from bench.plant.mjcf_file import read_mjcf
from bench.plant.robot import Robot, joint_rig, read_goals
from bench.rig.rig import Rig
from bench.servos.commanded import Gains
from bench.trace.trace import Trace


@dataclass(frozen=True)
class JointModel:
    """The values of an MJCF for a joint.

    Attributes:
        name: of the joint.
        robot: around it.
        rig: of the log's columns.
        stated: positions of joints that stand and that the log does not hold - rad (m).
        link_inertia: of what it carries, in the configuration of the MJCF - kg*m**2 (kg).
        armature, damping: of the joint in the MJCF - kg*m**2 (kg), N*m*s/rad (N*s/m).
        before: parameters of `bench.servos.model.NULL` of the position actuator that the MJCF has; None without one.
    """

    name: str
    robot: Robot
    rig: Rig
    stated: Mapping[str, float]
    link_inertia: float
    armature: float
    damping: float
    before: Mapping[str, float] | None

    @classmethod
    def of(cls, mjcf: Path, robot: Robot, rig: Rig | None, stated: Mapping[str, float], stand: bool) -> JointModel:
        """From the file of a robot, whose floating base is fixed or not, and the robot around the joint.

        InputError where the joint moves no mass.
        """
        model = read_mjcf(mjcf, stand)[0].compile()
        dof = int(model.joint(robot.joint).dofadr[0])
        armature, damping = float(model.dof_armature[dof]), float(model.dof_damping[dof])
        friction, inertia = float(model.dof_frictionloss[dof]), robot.inertia + armature
        if inertia <= 0.0:
            raise InputError(
                f"{mjcf}: joint '{robot.joint}'", "moves no mass", "allowed: a joint with a link or armature"
            )
        before = position_actuator(model, robot.joint)
        if before is not None:
            before = {name: value / inertia if name != "dead_time" else value for name, value in before.items()}
            before |= {"damping": damping / inertia, "friction": friction / inertia, "mobility": 1.0 / inertia}
        return cls(robot.joint, robot, joint_rig(rig, robot), stated, robot.inertia, armature, damping, before)

    @property
    def inertia(self) -> float:
        """Of link and armature - kg*m**2 (kg)."""
        return self.link_inertia + self.armature

    def read(self, log: str | Path | Trace) -> Trace:
        """A log on the joint's side of the gear, with the torque of the links; InputError as `read_goals`."""
        if isinstance(log, Trace):
            raise InputError("log", "found a trace in memory with an MJCF", "allowed: the file of a log of the robot")
        return read_goals(Path(log), self.rig, self.robot, self.stated)


def gains_of(mjcf: Path, stand: bool) -> dict[str, Gains]:
    """Gains of the joints of an MJCF that have a position actuator, by their names; InputError as `Robot.of`."""
    model, found = read_mjcf(mjcf, stand)[0].compile(), dict[str, Gains]()
    for name in (model.joint(k).name for k in range(model.njnt)):
        values = position_actuator(model, name) if name else None
        if values is not None:
            found[name] = Gains(values["stiffness"], max(values["drive_damping"], 0.0))
    return found


def position_actuator(model: mujoco.MjModel, joint: str) -> dict[str, float] | None:
    """kp, kv, delay and force limit of the position actuator on a joint, by their names; None where it has none."""
    here = model.joint(joint).id
    for k in range(model.nu):
        kp, (offset, stiffness, damping) = float(model.actuator_gainprm[k, 0]), model.actuator_biasprm[k, :3]
        on_joint = model.actuator_trntype[k] == int(mujoco.mjtTrn.mjTRN_JOINT) and model.actuator_trnid[k, 0] == here
        if on_joint and kp > 0.0 and offset == 0.0 and stiffness == -kp:
            gear = float(abs(model.actuator_gear[k, 0]))
            limit = float(np.abs(model.actuator_forcerange[k]).max()) if model.actuator_forcelimited[k] else np.inf
            found = {"stiffness": kp * gear**2, "drive_damping": -float(damping) * gear**2, "limit": limit * gear}
            return {**found, "dead_time": float(model.actuator_delay[k])}
    return None
