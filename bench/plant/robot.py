"""The rest of a robot, as a joint feels it along a log: gravity, the links' inertia, what other joints do to it.

Of MuJoCo's kinematics of the user's own MJCF, the joint's armature, damping and friction set to zero. With the spatial
momentum h of all that the joint carries, its spatial axis S, the momentum p = S.h along it, and the weight W,

    M_rest = dp/dt + r,  r = -(dS/dt).h - S.W - passive,

so that no acceleration is needed from the log (`bench.trace.trace`). The joint's own inertia at the
configuration of the MJCF is estimated by the balance, together with the armature: noise of its speed is then weighted
correctly (R. Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 2).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.errors import InputError
from bench.names import nearest
from bench.plant.axis_model import NO_MASS
from bench.plant.mjcf_file import read_mjcf
from bench.plant.silenced import silenced
from bench.rig.rig import JointNotes, Load, Rig
from bench.trace.channel import Channel, Recording
from bench.trace.choose import GivenOptions, axes_of
from bench.trace.joints import named
from bench.trace.motion import slope, stretches_of
from bench.trace.read import read_recording
from bench.trace.signals import RELATIVE, STANDING, STANDING_ASK, signal_of
from bench.trace.time_base import interpolate
from bench.trace.trace import Trace, assemble, with_known

#: Times of a log - s (n,) -, and where a robot's joints were, by name - rad (m) (n,).
Poses = tuple[Array, dict[str, Array]]
#: Times of a log - s -, by how much a link is ahead of its motor - rad (m) - and faster - rad/s (m/s) -, (n,) each.
Twist = tuple[Array, Array, Array]
#: Poses evaluated at once, which bounds memory.
TOGETHER = 4096
#: Time over which the change of the mass matrix along the motion is taken, to both sides - s.
ASIDE = 1e-4
#: A joint that moves so far - rad (m) - and has less torque than the residual was not what pushed.
FAR = 1.0
#: Joints of one coordinate, and its unit.
UNITS = {int(mujoco.mjtJoint.mjJNT_HINGE): "rad", int(mujoco.mjtJoint.mjJNT_SLIDE): "m"}
#: Step of a joint's position for the slope of a torque - rad (m).
SLOPE_STEP = 1e-3
#: Signals from which a joint's effort follows.
EFFORTS = frozenset({"torque", "force", "current", "voltage"})
#: Unit of the effort of a joint by that of its position.
UNITS_OF_EFFORT = {"rad": "N*m", "m": "N"}
#: What inverse dynamics leaves out: what is no property of the links.
DISABLED = int(
    mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    | mujoco.mjtDisableBit.mjDSBL_CONTACT
    | mujoco.mjtDisableBit.mjDSBL_ACTUATION
    | mujoco.mjtDisableBit.mjDSBL_SENSOR
)


@dataclass(frozen=True)
class AddedBody:
    """What a robot has in addition to its MJCF: a point of mass on a body, or more inertia of a link about its joint's
    axis.

    Attributes:
        body: that carries the mass.
        mass: kg.
        centre: of it in the body's frame - m.
        joint: whose link has more inertia.
        inertia: that, about the joint's axis - kg*m**2.
    """

    body: str = ""
    mass: float = 0.0
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    joint: str = ""
    inertia: float = 0.0


@dataclass(frozen=True)
class Counting:
    """How a log counts a joint, where that is not as the MJCF does.

    Attributes:
        joint: its name.
        zero: what is added to its position for that of the MJCF - rad (m).
        reversed: whether position, speed and torque are counted the other way.
    """

    joint: str
    zero: float = 0.0
    reversed: bool = False


#: In what a robot is not as its MJCF has it.
Change = AddedBody | Counting


def joint_units(path: Path) -> dict[str, str]:
    """Names of the hinges and slides of an MJCF file with the units of their positions; InputError as `Robot.of`."""
    model, _ = _loaded(path)
    found = {model.joint(k).name: UNITS.get(int(model.jnt_type[k])) for k in range(model.njnt)}
    return {name: unit for name, unit in found.items() if name and unit is not None}


def _loaded(path: Path, changes: Sequence[Change] = (), stand: bool = False) -> tuple[mujoco.MjModel, tuple[str, ...]]:
    spec, notes = read_mjcf(path, stand)
    added = {f"added {k}": one for k, one in enumerate(changes) if isinstance(one, AddedBody)}
    for name, one in added.items():
        add_body(spec, name, one, path)
    for one in changes:
        if isinstance(one, Counting):
            count_as(spec, one)
    with silenced():
        model = spec.compile()
    for name, one in added.items():  # a compiler wants inertias as bodies have them, and a change may be of either sign
        model.body_inertia[model.body(name).id] = 0.0, 0.0, one.inertia
    return model, notes


def count_as(spec: mujoco.MjSpec, one: Counting) -> None:
    """Have a joint of a robot count as its log does."""
    joint = spec.joint(one.joint)
    sign = -1.0 if one.reversed else 1.0
    zero = np.degrees(one.zero) if spec.compiler.degree and joint.type == mujoco.mjtJoint.mjJNT_HINGE else one.zero
    joint.axis = sign * joint.axis
    joint.ref, joint.springref = sign * joint.ref - zero, sign * joint.springref - zero
    joint.range = np.sort(sign * joint.range) - zero * bool(joint.range.any())


def add_body(spec: mujoco.MjSpec, name: str, one: AddedBody, path: Path) -> None:
    """Fix a body to one of a robot, whose z axis is the axis of the joint whose link has more inertia."""
    joint = spec.joint(one.joint) if one.joint else None
    body = spec.body(one.body) if joint is None else joint.parent
    if body is None:
        names = [each.name for each in spec.bodies if each.name]
        found = f"found no body '{one.body}'{nearest(one.body, names)}"
        raise InputError(path, found, f"allowed: {', '.join(names)}")
    child = body.add_body(name=name, pos=one.centre)
    child.explicitinertial, child.mass, child.inertia = True, max(one.mass, NO_MASS), [NO_MASS] * 3
    child.ipos, child.iquat = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    if joint is not None:
        turn = np.empty(4)
        mujoco.mju_quatZ2Vec(turn, joint.axis)
        child.quat = turn


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot around one of its joints.

    Attributes:
        model: without armature, damping and friction of the joint.
        joint: its name.
        source: file of the model.
        joints: numbers of the joints that move with it, itself among them, in the model's order: what depends on the
            world without them is not felt.
        notes: what was left out of the model.
        datum: inertia of all that the joint carries to which the load of the links is in addition - kg*m**2 (kg); None
            for that in the configuration of the MJCF.
        twists: of joints behind a soft or loose gear, by name.
    """

    model: mujoco.MjModel
    joint: str
    source: str
    joints: tuple[int, ...]
    notes: tuple[str, ...] = ()
    datum: float | None = None
    twists: Mapping[str, Twist] = field(default_factory=dict)

    @classmethod
    def of(cls, path: Path, joint: str | None, added: Sequence[Change] = (), stand: bool = False) -> Robot:
        """From an MJCF or URDF file, with what its robot has in addition; `stand` fixes a floating base.

        InputError if there is no such file or joint; if a joint of its tree has more than one coordinate; if a loop, a
        tendon or an equality of the MJCF puts a torque on it that is in no log.
        """
        model, notes = _loaded(path, added, stand)
        names = [model.joint(k).name for k in range(model.njnt)]
        if joint is None or joint not in names:
            found = "missing" if joint is None else f"found no joint '{joint}'{nearest(joint, names)}"
            where = "--joint" if joint is None else path
            raise InputError(where, found, f"allowed: {', '.join(filter(None, names)) or 'a joint with a name'}")
        trees = model.dof_treeid[model.jnt_dofadr]
        joints = tuple(int(k) for k in np.flatnonzero(trees == trees[model.joint(joint).id]))
        for k in joints:
            if int(model.jnt_type[k]) not in UNITS:
                body = model.body(int(model.jnt_bodyid[k])).name
                found = "found a free or ball joint, whose motion is in no log of joints"
                allowed = (
                    "for a robot on a stand, add `--stand` to bench robot or bench servo, or delete this joint and the "
                    "<keyframe> element from the file; on its feet the forces of the ground are in no log of joints"
                )
                raise InputError(f"{path}: body '{body}'", found, allowed)
        for reason in _bound(model, model.joint(joint).id):
            found = f"found {reason}, whose torque is in no log"
            raise InputError(f"{path}: joint '{joint}'", found, "allowed: a joint that only its motor moves")
        dof = model.joint(joint).dofadr[0]
        for own in (model.dof_armature, model.dof_damping, model.dof_dampingpoly, model.dof_frictionloss):
            own[dof] = 0.0
        model.opt.disableflags |= DISABLED
        return cls(model, joint, str(path), joints, notes)

    @property
    def names(self) -> list[str]:
        """Of `joints`."""
        return [self.model.joint(k).name for k in self.joints]

    @property
    def units(self) -> dict[str, str]:
        """Names of the other joints with the units of their positions."""
        return {name: self.unit(name) for name in self.names if name != self.joint}

    def unit(self, joint: str) -> str:
        """Of a joint's position."""
        return UNITS[int(self.model.joint(joint).type[0])]

    @property
    def link_inertia(self) -> float:
        """Of the joint's own link about its axis - kg*m**2."""
        model, joint = self.model, self.model.joint(self.joint)
        body, axis = int(joint.bodyid[0]), np.asarray(joint.axis) / np.linalg.norm(joint.axis)
        arm = np.cross(axis, model.body_ipos[body] - joint.pos)
        return link_about_centre(model, self.joint) + float(model.body_mass[body] * arm @ arm)

    @property
    def effort_limit(self) -> float | None:
        """Largest torque (force) that the MJCF allows the joint's actuators - N*m (N); None where it limits none."""
        model, joint = self.model, self.model.joint(self.joint).id
        allowed, known = [], model.actuator_trntype == int(mujoco.mjtTrn.mjTRN_JOINT)
        for k in np.flatnonzero(known & (model.actuator_trnid[:, 0] == joint)):
            largest = np.inf
            if model.actuator_forcelimited[k]:
                largest = np.abs(model.actuator_forcerange[k]).max()
            elif model.actuator_ctrllimited[k] and model.actuator_biastype[k] == int(mujoco.mjtBias.mjBIAS_NONE):
                largest = np.abs(model.actuator_ctrlrange[k]).max() * abs(model.actuator_gainprm[k, 0])
            allowed.append(abs(model.actuator_gear[k, 0]) * largest)
        most = sum(allowed) if allowed else np.inf
        if model.jnt_actfrclimited[joint]:
            most = min(most, np.abs(model.jnt_actfrcrange[joint]).max())
        return float(most) if np.isfinite(most) else None

    @cached_property
    def inertia(self) -> float:
        """Of all that the joint carries, the datum or in the configuration of the MJCF - kg*m**2 (kg)."""
        if self.datum is not None:
            return self.datum
        return float(self._own_inertia(self.model.qpos0[None])[0])

    @property
    def _dof(self) -> int:
        return int(self.model.joint(self.joint).dofadr[0])

    @cached_property
    def _carried(self) -> NDArray[np.bool_]:
        """Bodies that the joint carries (nbody,)."""
        return _carried(self.model, int(self.model.joint(self.joint).bodyid[0]))

    def rest(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """The load of the links on the joint in addition to its own inertia: r - N*m (N) - and p - N*m*s (N*s) -, (n,)
        each.

        Of positions and velocities of `joints` - rad (m), rad/s (m/s) - (n, joints).
        """
        dof = self._dof
        torque, momentum = np.empty((2, len(position)))
        for part in _parts(len(position)):
            q, w = self._posed(position[part], velocity[part])
            inertias, speeds, axes, turning, passive = self._evaluated(
                q, w, "cinert", "cvel", "cdof", "cdof_dot", "qfrc_passive"
            )
            inertias, speeds = inertias[:, self._carried], speeds[:, self._carried]
            carried, heavy = _spatial_momentum(inertias, speeds).sum(axis=1), inertias.sum(axis=1)
            gravity = self.model.opt.gravity
            weight = np.hstack([np.cross(heavy[:, 6:9], gravity), heavy[:, 9:] * gravity])
            torque[part] = -np.sum(turning[:, dof] * carried + axes[:, dof] * weight, axis=1) - passive[:, dof]
            momentum[part] = np.sum(axes[:, dof] * carried, axis=1) - self.inertia * w[:, dof]
        return torque, momentum

    def slope(self, position: Array, velocity: Array) -> Array:
        """How r of `rest` changes with the joint's own position - N*m/rad (N/m) - (n,)."""
        step = np.zeros_like(position)
        step[:, self.names.index(self.joint)] = SLOPE_STEP
        ahead, behind = (self.rest(position + side * step, velocity)[0] for side in (1.0, -1.0))
        return (ahead - behind) / (2.0 * SLOPE_STEP)

    def grown(self, position: Array) -> Array:
        """The joint's own inertia at positions of `joints` (n, joints) less `inertia` - kg*m**2 (kg) - (n,)."""
        found = np.empty(len(position))
        for part in _parts(len(position)):
            q, _ = self._posed(position[part], np.zeros_like(position[part]))
            found[part] = self._own_inertia(q) - self.inertia
        return found

    def _own_inertia(self, position: Array) -> Array:
        """Of all that the joint carries at coordinates (n, nq) - kg*m**2 (kg) - (n,)."""
        inertias, axes = self._evaluated(position, np.zeros((len(position), self.model.nv)), "cinert", "cdof")
        own = axes[:, self._dof]
        return np.sum(own * _spatial_momentum(inertias[:, self._carried].sum(axis=1), own), axis=1)

    def asked(self, changes: Sequence[Change], position: Array, velocity: Array) -> list[tuple[Array, Array]]:
        """The load of each of some changes on the joint in addition to that, r and p as `rest` has them."""
        borne = iter(self._borne([one for one in changes if isinstance(one, AddedBody)], position, velocity))
        still = self.rest(position, velocity) if any(isinstance(one, Counting) for one in changes) else None
        found = list[tuple[Array, Array]]()
        for one in changes:
            if isinstance(one, Counting) and still is not None:
                aside = position + one.zero * (np.array(self.names) == one.joint)
                moved = self.rest(aside, velocity) if self._feels(one.joint) else still
                found.append((moved[0] - still[0], moved[1] - still[1]))
            else:
                found.append(next(borne))
        return found

    def _feels(self, joint: str) -> bool:
        """Whether a joint is in one chain with this one."""
        if joint not in self.names:
            return False
        own, other = (int(self.model.joint(name).bodyid[0]) for name in (self.joint, joint))
        return bool(self._carried[other] or _carried(self.model, other)[own])

    def _borne(self, added: Sequence[AddedBody], position: Array, velocity: Array) -> list[tuple[Array, Array]]:
        """The same of what is added to bodies.

        Of a point of mass m that a joint moves by a column J of its Jacobian, with speed v,

            p = m*J*v,  r = -m*dJ/dt*v - m*J*g

        and so of an inertia, whose J is the joint's axis along its own.
        """
        if not added:
            return []
        found = [(np.empty(len(position)), np.empty(len(position))) for _ in added]
        own, model = self.names.index(self.joint), self.model
        standing = list(self._paths(added, model.qpos0[None, model.jnt_qposadr[list(self.joints)]]))
        for part in _parts(len(position)):
            q, w = position[part], velocity[part]
            paths = zip(*(self._paths(added, q + side * ASIDE * w) for side in (0.0, 1.0, -1.0)), strict=True)
            for one, (here, ahead, behind), still, (r, p) in zip(added, paths, standing, found, strict=True):
                weight, moved = one.inertia if one.joint else one.mass, np.einsum("knd,nk->nd", here, w)
                turning = np.sum((ahead[own] - behind[own]) * moved, axis=1) / (2.0 * ASIDE)
                r[part] = -weight * (turning + (0.0 if one.joint else here[own] @ model.opt.gravity))
                p[part] = weight * (np.sum(here[own] * moved, axis=1) - np.sum(still[own] ** 2) * w[:, own])
        return found

    def _paths(self, added: Sequence[AddedBody], position: Array) -> Iterator[Array]:
        """How each of some additions moves by each of `joints`, at their positions (n, joints): (joints, n, 3 or 1)."""
        model, (q, w) = self.model, self._posed(position, np.zeros_like(position))
        places, turns, anchors, axes = self._evaluated(q, w, "xpos", "xmat", "xanchor", "xaxis")
        for one in added:
            body = int(model.joint(one.joint).bodyid[0]) if one.joint else model.body(one.body).id
            place = places[:, body] + turns[:, body].reshape(-1, 3, 3) @ np.array(one.centre)
            found = []
            for k in self.joints:
                axis, hinge = axes[:, k], model.jnt_type[k] == int(mujoco.mjtJoint.mjJNT_HINGE)
                if one.joint:
                    along = axes[:, model.joint(one.joint).id]
                    path = np.sum(axis * along, axis=1, keepdims=True) * hinge
                else:
                    path = np.cross(axis, place - anchors[:, k]) if hinge else axis
                found.append(path * _carried(model, int(model.jnt_bodyid[k]))[body])
            yield np.array(found)

    def follows(self, name: str, motion: Mapping[str, tuple[Array, Array]]) -> tuple[Array, Array] | None:
        """Position and speed (n,) of a joint that an equality of the MJCF has follow another; None if none does."""
        model, here = self.model, self.model.joint(name).id
        for k in np.flatnonzero(model.eq_active0 & (model.eq_type == int(mujoco.mjtEq.mjEQ_JOINT))):
            leader = int(model.eq_obj2id[k])
            if model.eq_obj1id[k] == here and leader >= 0 and model.joint(leader).name in motion:
                position, velocity = motion[model.joint(leader).name]
                start, beyond = model.qpos0[model.jnt_qposadr[[here, leader]]]
                course = np.polynomial.Polynomial(model.eq_data[k, :5])
                return start + course(position - beyond), course.deriv()(position - beyond) * velocity
        return None

    def _posed(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Coordinates and their speeds, (n, nq) and (n, nv), with the joints so and all else as the MJCF has it."""
        model, joints = self.model, list(self.joints)
        q, w = np.tile(model.qpos0, (len(position), 1)), np.zeros((len(position), model.nv))
        q[:, model.jnt_qposadr[joints]], w[:, model.jnt_dofadr[joints]] = position, velocity
        return q, w

    def _evaluated(self, position: Array, velocity: Array, *fields: str) -> list[Array]:
        """Fields of MuJoCo's data at poses, (n, ...) each."""
        batch = Batch(self.model, len(position))
        bound = [batch.bind(field) for field in fields]
        batch.bind("qpos")[:], batch.bind("qvel")[:] = position, velocity
        batch.forward()
        return [np.array(values) for values in bound]


def _spatial_momentum(inertia: Array, speed: Array) -> Array:
    """Of spatial inertias (..., 10) and speeds (..., 6), rotation first, as MuJoCo has them: (..., 6)."""
    about = inertia[..., [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
    moment, mass, turning, moving = inertia[..., 6:9], inertia[..., 9:], speed[..., :3], speed[..., 3:]
    angular = np.squeeze(about @ turning[..., None], -1) + np.cross(moment, moving)
    return np.concatenate([angular, mass * moving - np.cross(moment, turning)], axis=-1)


def _parts(poses: int) -> Iterator[slice]:
    """Poses in turn, as many as are evaluated at once."""
    return (slice(start, start + TOGETHER) for start in range(0, poses, TOGETHER))


def link_about_centre(model: mujoco.MjModel, name: str) -> float:
    """Inertia of a joint's own link about its centre, along the joint's axis - kg*m**2."""
    joint = model.joint(name)
    body, axis, turn = int(joint.bodyid[0]), np.asarray(joint.axis) / np.linalg.norm(joint.axis), np.empty(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    return float(model.body_inertia[body] @ (turn.reshape(3, 3).T @ axis) ** 2)


def _bound(model: mujoco.MjModel, joint: int) -> Iterator[str]:
    """What of a model, if anything, puts a torque on a joint other than its motor, its links and its spring."""
    tied = model.eq_active0.astype(bool)
    ends = np.column_stack([model.eq_obj1id, model.eq_obj2id])
    of = {name: tied & (model.eq_type == int(getattr(mujoco.mjtEq, f"mjEQ_{name}"))) for name in ("JOINT", "TENDON")}
    if (ends[of["JOINT"]] == joint).any():
        yield "an equality that couples it with another joint"
    driven = model.actuator_trnid[model.actuator_trntype == int(mujoco.mjtTrn.mjTRN_TENDON), 0]
    for k in _moved_tendons(model, joint):
        if (
            k in driven
            or model.tendon_frictionloss[k] > 0.0
            or model.tendon_armature[k] > 0.0
            or k in ends[of["TENDON"]]
        ):
            yield f"the tendon '{model.tendon(k).name}' on it"
    carried = _carried(model, int(model.jnt_bodyid[joint]))
    closing = [int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD)]
    for k in np.flatnonzero(tied & np.isin(model.eq_type, closing)):
        sites = model.eq_objtype[k] == int(mujoco.mjtObj.mjOBJ_SITE)
        bodies = model.site_bodyid[ends[k]] if sites else ends[k]
        if carried[bodies[0]] != carried[bodies[1]]:
            yield "a loop that an equality closes over it"


def _carried(model: mujoco.MjModel, body: int) -> NDArray[np.bool_]:
    """Bodies that a body carries, itself among them (nbody,)."""
    found = np.zeros(model.nbody, dtype=bool)
    for k in range(model.nbody):
        found[k] = k == body or (k > 0 and found[model.body_parentid[k]])
    return found


def _moved_tendons(model: mujoco.MjModel, joint: int) -> Sequence[int]:
    """Tendons whose length changes with a joint, at a pose in which nothing is straight."""
    data, lengths = mujoco.MjData(model), []
    for aside in (0.1, 0.1 + 1e-3):
        data.qpos[model.jnt_qposadr] = model.qpos0[model.jnt_qposadr] + 0.1
        data.qpos[model.jnt_qposadr[joint]] = model.qpos0[model.jnt_qposadr[joint]] + aside
        with silenced():
            mujoco.mj_fwdPosition(model, data)
        lengths.append(data.ten_length.copy())
    return np.flatnonzero(np.abs(lengths[1] - lengths[0]) > 1e-9).tolist()


def joint_rig(rig: Rig | None, robot: Robot) -> Rig:
    """The rig of a joint, or one with its kind only, with the robot's links; InputError where it is of another kind."""
    turns = robot.unit(robot.joint) == "rad"
    alone = {"name": robot.joint, "kind": "rotary" if turns else "linear"}
    own = Rig.of(alone, robot.source) if rig is None else rig.of_joint(robot.joint)
    if own.axis_kind.turns is not turns:
        found = f"found a joint that {'turns' if turns else 'slides'}"
        raise InputError(f"--joint {robot.joint}", found, f"allowed: a {own.kind} one, as in {own.source}")
    return rig_within(own, robot)


def rig_within(rig: Rig, robot: Robot) -> Rig:
    """The rig of a joint whose links are in the robot's model."""
    known = {"link_inertia": robot.inertia, "effort_limit": robot.effort_limit}
    load = (rig.load or Load()).model_copy(update=known)
    return rig.model_copy(update={"load": load})


def read_log(path: Path, rig: Rig, robot: Robot, stated: Mapping[str, float]) -> Trace:
    """A log of a joint with the torque of the rest of the robot.

    The log contains, in addition to the joint's own signals, the position of every other joint, and its velocity where
    that is recorded, by their names in the MJCF or by their numbers in its order (`bench.trace.joints`), or as the
    rig's `[joints.NAME]` states; joints that it does not contain are where they are `stated` to - rad (m). What has no
    unit is taken for SI. The rig's gear lies between the log's position and the joint's.

    Raises:
        InputError: the log cannot be read, a joint is neither in it nor stated, is beyond what the MJCF allows by
            the unit assumed, or its effort is in A or V, which the MJCF's links are not.
    """
    return read_along(path, rig, robot, stated)[0]


def read_along(path: Path, rig: Rig, robot: Robot, stated: Mapping[str, float]) -> tuple[Trace, Poses]:
    """The same, and where the robot's joints were meanwhile."""
    (trace,), poses = logs_of(path, rig, robot, stated)
    return trace, poses


def read_goals(path: Path, rig: Rig, robot: Robot, stated: Mapping[str, float]) -> Trace:
    """A log of a joint's goal and position with the torque of its links, all on the joint's side; it needs no effort.

    InputError as `read_log`, but for an effort.
    """
    trace, position, velocity, _ = _moved(path, rig, robot, stated)
    ratio, unit = (rig.of_joint(robot.joint).load or Load()).gear_ratio, UNITS_OF_EFFORT[robot.unit(robot.joint)]
    moved = "position", "velocity", "position_reference", "velocity_reference"
    own = {name: trace[name] / ratio for name in moved if name in trace}
    known, slope = robot.rest(position, velocity), robot.slope(position, velocity)
    return with_known(trace.with_signals(own, {}), *known, unit, slope=slope)


def read_commanded(path: Path, rig: Rig, robot: Robot, stated: Mapping[str, float]) -> tuple[Trace, Poses]:
    """A log of a joint's goal and position with the load of its links, all on the joint's side, and the robot's poses.

    InputError as `read_log`, but for an effort. Speeds are derivatives of positions.
    """
    trace, position, _, _ = _moved(path, rig, robot, stated)
    ratio, unit = (rig.of_joint(robot.joint).load or Load()).gear_ratio, UNITS_OF_EFFORT[robot.unit(robot.joint)]
    velocity = np.zeros_like(position)
    for part in stretches_of(trace):
        velocity[part] = slope(position[part], trace.sample_period)
    own = {name: trace[name] / ratio for name in ("position", "position_reference") if name in trace}
    trace = replace(trace, signals=own, units={name: trace.units[name] for name in own})
    known = with_known(trace, *robot.rest(position, velocity), unit, robot.grown(position))
    return known, _poses(trace, position, robot)


def is_commanded(path: Path, rig: Rig, robot: Robot) -> bool:
    """Whether a log has goals of a joint and no effort; InputError where it cannot be read."""
    every = (robot.model.joint(k).name for k in range(robot.model.njnt))
    recording, own = named(read_recording(path), list(filter(None, every))), rig.of_joint(robot.joint)
    if not (_holds(recording, robot.joint) or own.trace.columns or own.trace.axis):
        return False
    trace = _joint_of(recording, robot.joint, own, robot)
    return "position_reference" in trace and EFFORTS.isdisjoint(trace.signals)


def logs_of(
    path: Path, rig: Rig, robot: Robot, stated: Mapping[str, float], changes: Sequence[Change] = ()
) -> tuple[list[Trace], Poses]:
    """A log as `read_log` has it, then of the robot with each of some changes; and where its joints were."""
    own = rig.of_joint(robot.joint)
    trace, position, velocity, stand = _moved(path, rig, robot, stated)
    unit = own.effort(trace)[1]
    if unit != own.effort_unit:
        if unit == RELATIVE:
            column = f'`{own.axis_kind.effort} = "COLUMN [1.5 {own.effort_unit}]"` for 1 % of 150 {own.effort_unit}'
            allowed = f"allowed: {own.effort_unit}, as {column} under [joints.{robot.joint}.columns] in a rig"
        else:
            allowed = f"allowed: {own.effort_unit}, or its torque_constant under [joints.{robot.joint}] in a rig"
        where = f"{trace.origin}: joint '{robot.joint}'"
        raise InputError(where, f"found an effort in {unit}, with links in kg", allowed)
    torque, momentum = robot.rest(position, velocity)
    slope = robot.slope(position, velocity)
    if robot.joint in robot.twists:  # as the motor has it, by what links ask where they are
        angle, rate = _twisted(robot, robot.joint, trace)
        ahead = rate[:, None] * (np.array(robot.names) == robot.joint)
        torque, momentum = torque - slope * angle, robot.rest(position, velocity - ahead)[1]
    more = robot.asked(changes, position, velocity)
    every = [(torque, momentum), *((torque + asked, momentum + moving) for asked, moving in more)]
    ratio = (own.load or Load()).gear_ratio
    grown = robot.grown(position) / ratio**2
    known = [
        with_known(trace, asked / ratio, moving / ratio, own.effort_unit, grown, slope / ratio**2)
        for asked, moving in every
    ]
    standing = _standing(position, velocity, torque, robot, stand, ratio)
    told = [replace(one, notes=(*robot.notes, *one.notes), metadata={**one.metadata, **standing}) for one in known]
    return told, _poses(trace, position, robot)


def _standing(
    position: Array, velocity: Array, torque: Array, robot: Robot, stand: Sequence[str], ratio: float
) -> dict[str, str]:
    """Where other joints were stated to stand, in words, and what one that moved would ask of the motor - N*m (N)."""
    if not stand:
        return {}
    names, asked = robot.names, 0.0
    for name in stand:
        aside = position.copy()
        aside[:, names.index(name)] += FAR
        asked = max(asked, rms(robot.rest(aside, velocity)[0] - torque) / ratio)
    places = (f"{name} at {position[0, names.index(name)]:.4g} {robot.unit(name)}" for name in stand)
    return {STANDING: ", ".join(places), STANDING_ASK: repr(asked)}


def _moved(path: Path, rig: Rig, robot: Robot, stated: Mapping[str, float]) -> tuple[Trace, Array, Array, list[str]]:
    """A joint's own signals, how the robot's `joints` moved - rad (m), rad/s (m/s) - (n, joints), and which are stated.

    InputError as `read_log`.
    """
    every = (robot.model.joint(k).name for k in range(robot.model.njnt))
    recording = named(read_recording(path), list(filter(None, every)))
    own, load = rig.of_joint(robot.joint), rig.of_joint(robot.joint).load or Load()
    known = own.trace.columns or own.trace.axis or _holds(recording, robot.joint)
    if not known and (any(_holds(recording, name) for name in robot.units) or len(axes_of(recording.channels)) > 1):
        allowed = f"allowed: a column '{robot.joint}.position [rad]' and so on{_which(recording, robot.joint)}"
        raise InputError(f"{path}: joint '{robot.joint}'", "has no column of its own", allowed)
    trace, ratio = _joint_of(recording, robot.joint, own, robot), load.gear_ratio
    if load.behind_rotor and own.axis_kind.effort in trace:
        trace = trace.with_signals({own.axis_kind.effort: trace[own.axis_kind.effort] / ratio}, {})
    position, velocity = _motion(trace, trace)
    motion, stand = {robot.joint: (position / ratio, velocity / ratio)}, list[str]()
    for name in robot.units:
        if name in rig.joints or _holds(recording, name):
            motion[name] = _motion(_joint_of(recording, name, rig, robot), trace)
        elif name in stated:
            motion[name] = np.full(len(trace), stated[name]), np.zeros(len(trace))
            stand.append(name)
    for name in robot.names:
        found = motion.get(name) or robot.follows(name, motion)
        if found is None:
            allowed = f"allowed: a column '{name}.position [rad]', or --at {name}=0{_which(recording, name)}"
            raise InputError(f"{path}: joint '{name}'", "is neither in the log nor stated", allowed)
        motion[name] = found
        if name in robot.twists:
            angle, rate = _twisted(robot, name, trace)
            motion[name] = found[0] + angle, found[1] + rate
        _require_within(found[0], name, robot, path)
    position, velocity = (np.column_stack([motion[name][k] for name in robot.names]) for k in (0, 1))
    return trace, position, velocity, stand


def _which(recording: Recording, joint: str) -> str:
    """What to write where the log has another name for a joint, behind what else is allowed."""
    axes = axes_of(recording.channels)
    if not axes:
        return f", or columns under [joints.{joint}.columns] in a rig"
    return f', or which one of the log it is ({", ".join(axes)}): `axis = "{axes[0]}"` under [joints.{joint}] in a rig'


def _twisted(robot: Robot, joint: str, trace: Trace) -> tuple[Array, Array]:
    """By how much the links of a joint are ahead of their motor along a log, and faster (n,) each."""
    time, *twist = robot.twists[joint]
    angle, rate = (np.interp(trace.time, time, more) for more in twist)
    return angle, rate


def poses_along(path: Path, rig: Rig, robot: Robot, stated: Mapping[str, float]) -> Poses:
    """Times of a log - s (n,) -, and where a robot's joints were, by name - rad (m) (n,); raises as `read_log`."""
    trace, position, _, _ = _moved(path, rig, robot, stated)
    return _poses(trace, position, robot)


def _poses(trace: Trace, position: Array, robot: Robot) -> Poses:
    """Of the positions of a robot's `joints` (n, joints)."""
    return trace.time, dict(zip(robot.names, position.T, strict=True))


#: What a joint that slides has where messages give all joints as if they turned.
_SLIDES = {"rad": "m", "rad/s": "m/s", "N*m": "N"}


def _joint_of(recording: Recording, name: str, rig: Rig, robot: Robot) -> Trace:
    """The log of one of a robot's joints, counted as the robot's model does."""
    notes, angle = rig.joints.get(name, JointNotes()), robot.unit(name)
    how, period = (rig.trace, rig.trace.position_period) if name == robot.joint else (notes, None)
    axis = how.axis or (name if _holds(recording, name) else None)
    how = GivenOptions(how.columns, rig.trace.sample_period, period, axis)
    if angle == "m":
        recording = replace(recording, channels=tuple(map(_sliding, recording.channels)))
    units = {
        "position": angle,
        "position_reference": angle,
        "velocity": f"{angle}/s",
        "torque": "N*m",
        "force": "N",
        "current": "A",
        "time": "s",
    }
    recording = replace(recording, usual_units={**units, **recording.usual_units})
    trace = assemble(recording, how)
    turned = {one: -values for one, values in trace.signals.items() if notes.sign < 0 and one != "temperature"}
    return trace.with_signals(turned, {})


def _sliding(channel: Channel) -> Channel:
    """A column of a joint that slides: its effort is a force."""
    unit = _SLIDES.get(channel.unit or "", channel.unit)
    is_effort = (channel.signal or signal_of(channel.name)) == "torque"
    return replace(channel, unit=unit, **({"name": f"{channel.name}.force", "signal": "force"} if is_effort else {}))


def _require_within(position: Array, joint: str, robot: Robot, path: Path) -> None:
    """InputError where a joint is further beyond its limits than their distance: its unit is another."""
    at = robot.model.joint(joint).id
    low, high = robot.model.jnt_range[at]
    if robot.model.jnt_limited[at] and max(low - position.min(), position.max() - high) > high - low:
        unit = robot.unit(joint)
        found = f"is at {position.min():.4g} to {position.max():.4g} {unit}"
        allowed = f"allowed: {low:.4g} to {high:.4g} {unit}, as the MJCF limits it; its unit (or axis) may be another: "
        raise InputError(f"{path}: joint '{joint}'", found, f"{allowed}set columns under [joints.{joint}] in a rig")


def _holds(recording: Recording, name: str) -> bool:
    """Whether a log has signals of a joint."""
    return any(name == one.axis or name.lower() in one.name.lower().split(".") for one in recording.channels)


def _motion(trace: Trace, at: Trace) -> tuple[Array, Array]:
    """Position and speed of a joint - rad (m), rad/s (m/s) - at the times of another trace (n,)."""
    position = trace["position"]
    if "velocity" in trace:
        velocity = trace["velocity"]
    else:
        velocity = np.zeros_like(position)
        for part in stretches_of(trace):
            velocity[part] = np.gradient(position[part], trace.sample_period)
    if np.array_equal(trace.time, at.time):
        return position, velocity
    return interpolate(at.time, trace.time, position), interpolate(at.time, trace.time, velocity)
