"""What MuJoCo does not make by itself, in a simulation of one's own.

    effects = bench.Effects("found/model.toml", joint="elbow")
    while data.time < 10.0:
        data.ctrl[0] = ...
        effects.step(model, data)                    # in the place of mujoco.mj_step(model, data)

The joint is one that `bench export` has put the model onto, which carries what is native. Before each step effects set
the joint's dry friction (`dof_frictionloss`), its added inertia (`dof_armature`) and a torque (`qfrc_applied`), from
position, velocity, time and the torque of its actuators, as they do in the bench's own plant
(`bench.plant.stepped_effects`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.mjcf import AXIS, BRISTLES
from bench.effects.signals import Number
from bench.errors import InputError
from bench.plant.model_file import StoredModel, load_model
from bench.plant.stepped_effects import Joints, SimulationJoint, SteppedEffects, per_axis

#: Integrators whose step is one evaluation; a Runge-Kutta step has four, between which effects would have to act.
ONE_STAGE = (
    mujoco.mjtIntegrator.mjINT_EULER,
    mujoco.mjtIntegrator.mjINT_IMPLICIT,
    mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
)


class Effects:
    """Non-native effects of a model at a joint of another simulation.

    Args:
        model: path of a `model.toml`, or what `bench.plant.model_file.load_model` gives.
        joint: of the simulation.

    Raises:
        InputError: the model cannot be read.
    """

    def __init__(self, model: str | Path | StoredModel, joint: str = AXIS) -> None:
        self.stored = model if isinstance(model, StoredModel) else load_model(model)
        self.joint = joint
        self._running: _Running | None = None

    def step(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Advance a simulation by one step with the effects, instead of `mujoco.mj_step(model, data)`.

        InputError where the model has no such joint, or a Runge-Kutta integrator.
        """
        running = self._run(model, data)
        if self.stored.model.stepped:
            if running.needs_forces:
                mujoco.mj_forward(model, data)
            running.prepare(data.time)
        mujoco.mj_step(model, data)

    def install(self) -> None:
        """Have MuJoCo call the effects in each step of every simulation in this process, as its control callback.

        Torque and friction act in the step in which they are called, inertia in the next one. `mujoco.set_mjcb_control
        (None)` ends it. For one simulation only: MuJoCo calls it for all of them.
        """
        mujoco.set_mjcb_control(self.control)

    def control(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """The callback that `install` installs, for a callback of one's own to call: `data.ctrl` is set already."""
        running = self._run(model, data)
        if running.time == data.time:
            return  # mj_forward calls it too
        if running.needs_forces:
            mujoco.mj_fwdActuation(model, data)
        running.prepare(data.time)
        dof = model.joint(self.joint).dofadr[0]
        rows = (data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF)) & (data.efc_id == dof)
        data.efc_frictionloss[rows] = model.dof_frictionloss[dof]  # constraints are made before the callback,
        if data.nisland:  # and parted into islands
            data.iefc_frictionloss[data.map_efc2iefc[rows]] = model.dof_frictionloss[dof]

    def _run(self, model: mujoco.MjModel, data: mujoco.MjData) -> _Running:
        """The effects on a simulation; restarted if it is another one, or its time decreases."""
        running = self._running
        if running is None or running.data is not data or running.model is not model or data.time < running.time:
            if running is not None:
                running.joint.set_added_inertia(0.0)  # the inertia that the model had
            self._running = running = _Running(model, data, self.stored, self.joint)
        return running

    def on(self, batch: Batch, models: Sequence[StoredModel] | None = None) -> Copies:
        """The effects on many copies at once: a `mujoco.batch.Batch` of a model that has the joint.

        With models, one for each copy, theirs.
        """
        return Copies(batch, [self.stored] * batch.nsim if models is None else models, self.joint)


class Copies:
    """Effects on all simulations of a batch; `step` instead of `batch.step()`.

    InputError: not a model for each, gears that differ, no such joint, or a Runge-Kutta integrator.
    """

    def __init__(self, batch: Batch, models: Sequence[StoredModel], joint: str) -> None:
        if len(models) != batch.nsim:
            raise InputError("models", f"found {len(models)}", f"allowed: one for each of the {batch.nsim} copies")
        bristles = _bristles(batch.model, joint)
        ratios = {stored.mounting.gear_ratio for stored in models}
        if len(ratios) > 1:
            raise InputError("models", f"found gear ratios of {sorted(ratios)}", "allowed: copies of one joint")
        self._batch, self._time = batch, batch.bind("time")
        joints = Joints.of(batch, joint, ratios.pop(), bristles)
        self._effects = _AtJoint(joints, batch.model, joint, models, batch.bind)

    def step(self) -> None:
        """Advance all copies by one step with the effects."""
        if self._effects.needs_forces:
            self._batch.forward()
        self._effects.prepare(np.asarray(self._time).reshape(-1))
        self._batch.step()


class _AtJoint:
    """The effects at a joint of simulations side by side, of which `state` gives a field to be read, (copies, ...)."""

    def __init__(
        self,
        joints: Joints,
        model: mujoco.MjModel,
        joint: str,
        models: Sequence[StoredModel],
        state: Callable[[str], Array],
    ) -> None:
        here, self._ratio, self._joints = model.joint(joint), models[0].mounting.gear_ratio, joints
        self.time: Number = -np.inf
        self._position, self._velocity = state("qpos")[:, here.qposadr[0]], state("qvel")[:, here.dofadr[0]]
        self._actuators = Actuators.of(model, joint, self._ratio)
        self._control, self._force = state("ctrl"), state("actuator_force")
        self.needs_forces = self._actuators.needs_forces
        axes = [stored.model for stored in models]
        self._effects = SteppedEffects(joints, axes, self._ratio * per_axis(self._velocity))

    def prepare(self, time: Number) -> None:
        """Set the effects for the step that comes, at a time - s."""
        self.time = time
        position, velocity = (self._ratio * per_axis(each) for each in (self._position, self._velocity))
        demand = per_axis(self._actuators.torque(self._control, self._force))
        _, torque = self._effects.act(time, position, velocity, demand)
        self._joints.add_torque(torque - demand)


class _Running(_AtJoint):
    """The effects on one simulation, with what they remember of it."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, stored: StoredModel, joint: str) -> None:
        self.model, self.data = model, data
        self.joint = SimulationJoint(model, data, joint, stored.mounting.gear_ratio, _bristles(model, joint))
        super().__init__(self.joint, model, joint, [stored], lambda name: getattr(data, name)[None])


@dataclass(frozen=True)
class Actuators:
    """Actuators that drive a joint.

    Attributes:
        controls: places of their inputs in `ctrl` (k,).
        actuators: their numbers (k,).
        gears: motor torque per force of each (k,).
        gains: force per input (k,); nan where MuJoCo makes the force of more than that, and has to be asked.
        limits: lowest and highest input, and force, of each (k, 4).
    """

    controls: NDArray[np.intp]
    actuators: NDArray[np.intp]
    gears: Array
    gains: Array
    limits: Array

    @classmethod
    def of(cls, model: mujoco.MjModel, joint: str, ratio: float) -> Actuators:
        """All actuators with an input on a joint."""
        at_joint = model.actuator_trnid[:, 0] == model.joint(joint).id
        at_joint &= model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT
        chosen = np.flatnonzero(at_joint & (model.actuator_ctrlnum > 0))
        fixed = model.actuator_gaintype[chosen] == mujoco.mjtGain.mjGAIN_FIXED
        plain = fixed & (model.actuator_biastype[chosen] == mujoco.mjtBias.mjBIAS_NONE)
        plain &= model.actuator_dyntype[chosen] == mujoco.mjtDyn.mjDYN_NONE
        limits = np.full((chosen.size, 4), np.inf) * [-1.0, 1.0, -1.0, 1.0]
        for row, k in enumerate(chosen):
            if plain[row] and model.actuator_ctrllimited[model.actuator_ctrladr[k]]:
                limits[row, :2] = model.actuator_ctrlrange[model.actuator_ctrladr[k]]
            if model.actuator_forcelimited[k]:
                limits[row, 2:] = model.actuator_forcerange[k]
        gains = np.where(plain, model.actuator_gainprm[chosen, 0], np.nan)
        return cls(model.actuator_ctrladr[chosen], chosen, model.actuator_gear[chosen, 0] / ratio, gains, limits)

    @property
    def needs_forces(self) -> bool:
        """Whether MuJoCo has to compute forces first, as those of a servo or a winding."""
        return bool(np.isnan(self.gains).any())

    def torque(self, control: Array, force: Array) -> Array:
        """Torque of the motor - N*m (N) - (copies,), of inputs (copies, nu) and forces (copies, na)."""
        low, high, weakest, strongest = self.limits.T
        made = np.clip(np.clip(control[:, self.controls], low, high) * self.gains, weakest, strongest)
        return np.where(np.isnan(self.gains), force[:, self.actuators], made) @ self.gears


def _bristles(model: mujoco.MjModel, joint: str) -> str:
    """Actuator whose bristles are the joint's friction, as `bench export` or the bench's own model names it.

    InputError where the model has no such joint, or a Runge-Kutta integrator.
    """
    names = [model.joint(k).name for k in range(model.njnt)]
    if joint not in names:
        raise InputError(f"joint '{joint}'", "found none of that name", f"allowed: {', '.join(filter(None, names))}")
    if model.opt.integrator not in ONE_STAGE:
        raise InputError("option integrator", "found RK4", "allowed: Euler, implicit, implicitfast")
    exported = f"{joint} {BRISTLES}"
    return exported if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, exported) >= 0 else BRISTLES
