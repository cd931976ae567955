"""What MuJoCo does not make by itself, in a simulation of one's own: on MuJoCo, its batches, mujoco_warp and MJX.

    effects = bench.Effects("robot_id/effects.toml")  # all joints of a robot, or a model.toml and joint="elbow"
    while data.time < 10.0:
        data.ctrl[0] = ...
        effects.step(model, data)                     # in the place of mujoco.mj_step(model, data)

The joints are those that `bench export` has put the models onto, which carry what is native. Before each step effects
set the joints' dry friction (`dof_frictionloss`), their added inertia (`dof_armature`) and a torque (`qfrc_applied`),
from position, velocity, time and the torque of their actuators, as they do in the bench's own plant
(`bench.plant.stepped_effects`).

`AtJoints` and `Actuators` are on the joint's side of a gear. With i motor turns per turn of the joint, q_m = i*q and
M = i*M_m, so that friction is i times, inertia i**2 times the motor's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray

from bench.arrays import made_like, namespace
from bench.diagnosis.diagnosis import Diagnosis
from bench.effects.effect import Bristles
from bench.effects.mjcf import AXIS, BRISTLES
from bench.effects.signals import Number
from bench.errors import InputError
from bench.export.simulations import Joints, Simulations
from bench.plant.model_file import StoredModel, load_models
from bench.plant.stepped_effects import Acts, Made, Remembered, SteppedEffects, per_axis
from bench.presented import ByName

#: A model or its data of another engine, whose types are known where it is installed.
Foreign = Any
#: Integrators whose step is one evaluation; a Runge-Kutta step has four, between which effects would have to act.
ONE_STAGE = (
    mujoco.mjtIntegrator.mjINT_EULER,
    mujoco.mjtIntegrator.mjINT_IMPLICIT,
    mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
)


class Effects(ByName):
    """Non-native effects at joints of another simulation, all joints of which are one object's.

    Args:
        model: a diagnosis; path of a `model.toml`, or of the `effects.toml` of `bench robot`; or what `load_model` of
            `bench.plant.model_file` gives, or several of them by joint.
        joint: of the simulation that a lone model is for, or of an `effects.toml` the only one.

    Raises:
        InputError: the file cannot be read, or has no model of this joint.
    """

    def __init__(
        self, model: str | Path | StoredModel | Diagnosis | Mapping[str, StoredModel], joint: str | None = None
    ) -> None:
        if isinstance(model, Diagnosis):
            if model.model is None:
                raise InputError("model", "MuJoCo cannot have what was found", "allowed: a diagnosis with a model")
            model = model.model
        if isinstance(model, StoredModel):
            model = {joint or AXIS: model}
        self.models = (
            dict(model) if isinstance(model, Mapping) else load_models(model, () if joint is None else (joint,))
        )
        self._running: Worlds | None = None
        self._simulated: tuple[mujoco.MjModel, mujoco.MjData] | None = None

    def step(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Advance a simulation by one step with the effects, instead of `mujoco.mj_step(model, data)`.

        InputError where the model has no such joint, or a Runge-Kutta integrator.
        """
        self._run(model, data).step()

    def install(self) -> None:
        """Have MuJoCo call the effects in each step of every simulation in this process, as its control callback.

        Torque and friction act in the step in which they are called, inertia in the next one. `mujoco.set_mjcb_control
        (None)` ends it. For one simulation only: MuJoCo calls it for all of them. InputError where it calls something
        else already.
        """
        if mujoco.get_mjcb_control() not in (None, self.control):
            allowed = (
                "allowed: one bench.Effects with the models of all joints, or `effects.control` called in your own"
            )
            raise InputError("MuJoCo's control callback", "found another one", allowed)
        mujoco.set_mjcb_control(self.control)

    def control(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """The callback that `install` installs, for a callback of one's own to call: `data.ctrl` is set already."""
        running = self._run(model, data)
        if running.last == data.time:
            return  # mj_forward calls it too
        running.prepare(lambda: mujoco.mj_fwdActuation(model, data))
        dofs = [model.joint(name).dofadr[0] for name in running.joints]
        rows = (data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF)) & np.isin(data.efc_id, dofs)
        levels = model.dof_frictionloss[data.efc_id[rows]]
        data.efc_frictionloss[rows] = levels  # constraints are made before the callback,
        if data.nisland:  # and parted into islands
            data.iefc_frictionloss[data.map_efc2iefc[rows]] = levels

    def _run(self, model: mujoco.MjModel, data: mujoco.MjData) -> Worlds:
        """The effects on a simulation; others if it is another one."""
        known = self._simulated
        if self._running is None or known is None or known[0] is not model or known[1] is not data:
            if self._running is not None and self._running.joints:
                self._running.place.restore_inertia()
            self._running, self._simulated = Worlds(self.models, Simulations.lone(model, data)), (model, data)
        return self._running

    def on(self, batch: Batch, models: Sequence[StoredModel | Mapping[str, StoredModel]] | None = None) -> Worlds:
        """The effects on many copies at once: a `mujoco.batch.Batch` of a model that has the joints.

        With models, one for each copy, theirs; of several joints by name. InputError as `step`, or not one for each.
        """
        if models is not None and len(models) != batch.nsim:
            raise InputError("models", f"found {len(models)}", f"allowed: one for each of the {batch.nsim} copies")
        own = None
        if models is not None:
            own = [one if isinstance(one, Mapping) else dict.fromkeys(self.models, one) for one in models]
        return Worlds(self.models, Simulations.of(batch), own)

    def on_warp(self, model: mujoco.MjModel, warp_model: Foreign, warp_data: Foreign) -> Worlds:
        """The effects on all worlds of mujoco_warp: `model`, and what its `put_model` and `put_data` made from it.

        Fields of the model that effects change become those of each world. On a GPU this needs torch.
        """
        mujoco_warp, warp = import_module("mujoco_warp"), import_module("warp")
        view = warp.to_torch if warp_data.qpos.device.is_cuda else lambda array: array.numpy()
        count = int(warp_data.nworld)

        def field(name: str) -> Number:
            one = getattr(warp_model, name)
            if one.shape[0] < count:
                values = np.repeat(one.numpy()[:1], count, axis=0)
                setattr(warp_model, name, warp.array(values, dtype=one.dtype, device=one.device))
            return view(getattr(warp_model, name))

        simulations = Simulations(
            model,
            count,
            cache(lambda name: view(getattr(warp_data, name))),
            cache(field),
            lambda: mujoco_warp.forward(warp_model, warp_data),
            lambda: mujoco_warp.step(warp_model, warp_data),
        )
        return Worlds(self.models, simulations)

    def on_mjx(self, model: mujoco.MjModel, mjx_model: Foreign) -> Mjx:
        """The effects in MJX: `model`, and what `mjx.put_model` made from it."""
        return Mjx(self.models, model, mjx_model)

    def on_arrays(self, like: Number, step: float) -> AtJoints:
        """The effects as a function of arrays (..., joints) of a library, as torch's, in the order of `models`.

        Args:
            like: an array of it, whose device and precision they take.
            step: of the integration - s.
        """
        models = list(self.models.values())
        return AtJoints(models, step, bristled(models), made_like(like))


class Worlds:
    """Effects on simulations side by side; `step` instead of their own step.

    Args:
        models: of joints by name.
        simulations: that have these joints.
        own: the models of each simulation, where they differ.
    """

    def __init__(
        self,
        models: Mapping[str, StoredModel],
        simulations: Simulations,
        own: Sequence[Mapping[str, StoredModel]] | None = None,
    ) -> None:
        model, each = simulations.model, own or [models]
        require(model, models)
        self.joints = [name for name in models if any(one[name].model.stepped for one in each)]
        self._simulations, self._own = simulations, own is not None
        self.last: Number = -np.inf
        if not self.joints:
            return
        self.place = _Place(simulations, self.joints)
        made = made_like(self.place.applied)
        self._actuators = Actuators(model, self.joints, made)
        axes = [one[name] for one in each for name in self.joints]
        self._effects = AtJoints(axes, float(model.opt.timestep), np.tile(self.place.bristled, len(each)), made)
        here = [model.joint(name) for name in self.joints]
        self._at = {"qpos": [int(j.qposadr[0]) for j in here], "qvel": [int(j.dofadr[0]) for j in here]}
        self._memory: Remembered | None = None

    def step(self) -> None:
        """Advance all simulations by one step with the effects."""
        self.prepare()
        self._simulations.advance()

    def prepare(self, forward: Callable[[], object] | None = None) -> None:
        """Set the effects for the step that comes, for a loop that makes it by itself; `forward` computes forces."""
        if not self.joints:
            return
        state = self._simulations.state
        if self._actuators.needs_forces:
            (forward or self._simulations.forward)()
        time = state("time").reshape(-1, 1)
        again, self.last = time < self.last, time + 0.0
        position, velocity = (self._axes(state(name)[:, at]) for name, at in self._at.items())
        if self._memory is None:
            self._memory = self._effects.start(velocity)
        elif self._simulations.count > 1 or again:
            self._memory = self._effects.again(self._memory, self._axes(again), velocity)
            self.place.again(again)
        torque = self._axes(self._actuators.torque(state("ctrl"), state("actuator_force")))
        acts = self._effects.act(self._memory, self._axes(time), position, velocity, torque)
        self._memory = acts.memory
        self.place.take(acts)

    def _axes(self, values: Number) -> Number:
        """Values (simulations, joints) as the effects have them: by joint, or of each on its own; of a lone one, it."""
        if self._own:
            whole = namespace(values).broadcast_to(values, (self._simulations.count, len(self.joints)))
            return whole.reshape(-1) if whole.size > 1 else whole[0, 0]
        return values[0, 0] if self._simulations.count * len(self.joints) == 1 else values


class _Place(Joints):
    """Joints of simulations, in addition to whatever else is applied to them."""

    def __init__(self, simulations: Simulations, joints: Sequence[str]) -> None:
        model, kind = simulations.model, mujoco.mjtObj.mjOBJ_ACTUATOR
        exported = (f"{joint} {BRISTLES}" for joint in joints)
        bristles = [name if mujoco.mj_name2id(model, kind, name) >= 0 else BRISTLES for name in exported]
        super().__init__(simulations, joints, bristles)
        self._given: Number = 0.0

    def apply(self, torque: Number) -> None:
        """In the place of what was applied before; what others apply stays."""
        self.applied[:, self._columns] += torque - self._given
        self._given = torque

    def again(self, where: Number) -> None:
        """Nothing was applied yet where simulations were reset: bool - (simulations, 1)."""
        self._given = namespace(where).where(where, 0.0 * self._given, self._given)


class Mjx:
    """Effects in MJX, which is functional: what they remember goes in and out of each step.

        mjx_effects = effects.on_mjx(model, mx)
        memory = mjx_effects.start(dx)
        dx, memory = jax.jit(mjx_effects.step)(mx, dx, memory)  # under jax.vmap with many worlds

    InputError where the model has no such joint, or a Runge-Kutta integrator.
    """

    def __init__(self, models: Mapping[str, StoredModel], model: mujoco.MjModel, mjx_model: Foreign) -> None:
        require(model, models)
        made = made_like(mjx_model.dof_armature)
        axes = {name: stored for name, stored in models.items() if stored.model.stepped}
        self._actuators = Actuators(model, list(axes), made)
        self._q = np.array([model.joint(name).qposadr[0] for name in axes], dtype=np.intp)
        self._w = np.array([model.joint(name).dofadr[0] for name in axes], dtype=np.intp)
        carried = bristled(axes.values())
        if carried.any():
            found = "found bristles, whose level MJX does not let change"
            raise InputError(f"joint '{list(axes)[int(carried.argmax())]}'", found, "allowed: on_warp, or without them")
        self._effects = AtJoints(list(axes.values()), float(model.opt.timestep), carried, made)

    def start(self, mjx_data: Foreign) -> Remembered:
        """What is remembered before a first step."""
        return self._effects.start(mjx_data.qvel[self._w])

    def step(self, mjx_model: Foreign, mjx_data: Foreign, memory: Remembered) -> tuple[Foreign, Remembered]:
        """One step with the effects, instead of `mjx.step(mjx_model, mjx_data)`; and what is remembered of it."""
        from mujoco import mjx

        if self._actuators.needs_forces:
            mjx_data = mjx.forward(mjx_model, mjx_data)
        torque = self._actuators.torque(mjx_data.ctrl, mjx_data.actuator_force)
        position, velocity = mjx_data.qpos[self._q], mjx_data.qvel[self._w]
        acts = self._effects.act(memory, mjx_data.time, position, velocity, torque)
        changed = {}
        if acts.inertia is not None:
            changed["dof_armature"] = mjx_model.dof_armature.at[self._w].add(acts.inertia)
        if acts.friction is not None:
            changed["dof_frictionloss"] = mjx_model.dof_frictionloss.at[self._w].set(acts.friction)
        own = mjx_data.qfrc_applied
        stepped = mjx.step(
            mjx_model.replace(**changed), mjx_data.replace(qfrc_applied=own.at[self._w].add(acts.torque))
        )
        return stepped.replace(qfrc_applied=own), acts.memory


def bristled(models: Iterable[StoredModel]) -> NDArray[np.bool_]:
    """Of which joints' models native bristles carry the friction (joints,)."""
    return np.array([any(isinstance(p.effect, Bristles) for p in m.model.native) for m in models], dtype=bool)


def require(model: mujoco.MjModel, joints: Iterable[str]) -> None:
    """InputError where a model has not all of these joints, or a Runge-Kutta integrator."""
    names = [model.joint(k).name for k in range(model.njnt)]
    for joint in joints:
        if joint not in names:
            allowed = f"allowed: {', '.join(filter(None, names))}"
            raise InputError(f"joint '{joint}'", "found none of that name", allowed)
    if model.opt.integrator not in ONE_STAGE:
        raise InputError("option integrator", "found RK4", "allowed: Euler, implicit, implicitfast")


class AtJoints:
    """What MuJoCo does not make by itself, at joints side by side: a function of arrays (..., joints) of any library.

    Args:
        models: of each joint.
        step: of the integration - s.
        bristled: of which joints bristles carry the friction (joints,).
        made: makes arrays of the library.
    """

    def __init__(self, models: Sequence[StoredModel], step: float, bristled: NDArray[np.bool_], made: Made) -> None:
        ratio = np.array([stored.mounting.gear_ratio for stored in models])
        self._ratio = made(per_axis(ratio))
        self._levels = made(per_axis(np.where(bristled, 1.0, ratio)))  # bristles are behind the gear themselves
        self._effects = SteppedEffects([stored.model for stored in models], step, bristled, made)

    def start(self, velocity: Number) -> Remembered:
        """What is remembered before a first step, of the joints' velocity - rad/s (m/s) - (..., joints)."""
        return self._effects.start(self._ratio * velocity)

    def again(self, memory: Remembered, where: Number, velocity: Number) -> Remembered:
        """A memory that begins again where simulations were reset: bool - (..., joints), or one for all joints."""
        return self._effects.again(memory, where, self._ratio * velocity)

    def act(self, memory: Remembered, time: Number, position: Number, velocity: Number, torque: Number) -> Acts:
        """What acts in the step that comes.

        Args:
            memory: of the step before.
            time: at the start of the step - s - one for all, or (..., joints).
            position, velocity: of the joints then - rad (m), rad/s (m/s) - (..., joints).
            torque: of their actuators - N*m (N) - (..., joints).

        Returns:
            `torque` to apply in addition to the actuators', `friction` level and additional `inertia` of the joints,
            which are None where no effect changes them, and the `memory` of this step.
        """
        ratio = self._ratio
        acts = self._effects.act(memory, time, ratio * position, ratio * velocity, torque / ratio)
        return acts._replace(
            torque=ratio * (acts.torque + acts.motor) - torque,
            friction=None if acts.friction is None else self._levels * acts.friction,
            inertia=None if acts.inertia is None else ratio**2 * acts.inertia,
        )


class Actuators:
    """Actuators with an input that drive joints of a model, as arrays of the library that steps.

    Attributes:
        needs_forces: whether MuJoCo has to compute forces first, as those of a servo or a winding.
    """

    def __init__(self, model: mujoco.MjModel, joints: Sequence[str], made: Made) -> None:
        ids = np.array([model.joint(name).id for name in joints], dtype=np.intp)
        on = (model.actuator_trnid[:, :1] == ids) & (model.actuator_trntype[:, None] == mujoco.mjtTrn.mjTRN_JOINT)
        chosen = np.flatnonzero(on.any(axis=1) & (model.actuator_ctrlnum > 0))
        plain = model.actuator_gaintype[chosen] == mujoco.mjtGain.mjGAIN_FIXED
        plain &= model.actuator_biastype[chosen] == mujoco.mjtBias.mjBIAS_NONE
        plain &= model.actuator_dyntype[chosen] == mujoco.mjtDyn.mjDYN_NONE
        limits = np.full((4, chosen.size), np.inf) * [[-1.0], [1.0], [-1.0], [1.0]]  # of inputs, and of forces
        for column, k in enumerate(chosen):
            if plain[column] and model.actuator_ctrllimited[model.actuator_ctrladr[k]]:
                limits[:2, column] = model.actuator_ctrlrange[model.actuator_ctrladr[k]]
            if model.actuator_forcelimited[k]:
                limits[2:, column] = model.actuator_forcerange[k]
        self.needs_forces = not plain.all()
        self._limits = [made(bound) for bound in limits] if np.isfinite(limits).any() else None
        self._controls, self._numbers = made(model.actuator_ctrladr[chosen].astype(np.intp)), made(chosen)
        self._gears = made(np.where(on[chosen], model.actuator_gear[chosen, :1], 0.0))
        self._gains = made(np.where(plain, model.actuator_gainprm[chosen, 0], 0.0))
        self._asked = made(~plain)

    def torque(self, control: Number, force: Number) -> Number:
        """Torque of the joints - N*m (N) - (..., joints), of inputs (..., nu) and forces (..., actuators)."""
        xp = namespace(control)
        inputs = xp.take(control, self._controls, axis=-1)
        driven = inputs * self._gains
        if self._limits is not None:
            low, high, weakest, strongest = self._limits
            driven = xp.clip(xp.clip(inputs, low, high) * self._gains, weakest, strongest)
        if self.needs_forces:
            driven = xp.where(self._asked, xp.take(force, self._numbers, axis=-1), driven)
        return driven @ self._gears
