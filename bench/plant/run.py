"""Run axes: those that MuJoCo runs by itself natively in C, the others tick by tick."""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from copy import copy
from operator import attrgetter

import mujoco
import numpy as np
from mujoco import rollout
from mujoco.batch import MODEL_FIELDS, Batch

from bench.arrays import Array
from bench.effects.mjcf import AXIS, BRISTLE_LEVELS, BRISTLES, DRIVE, LINKS
from bench.errors import InputError, SimulationError
from bench.plant.drive import TORQUE, CascadeDrive, References
from bench.plant.plant import DIVERGED, ClosedLoop, PlannedInputs, Plant, States
from bench.plant.silenced import silenced
from bench.plant.stepped_effects import SteppedEffects

Progress = Callable[[float], None]

#: Loops that take no more time side by side than one after the other.
MANY = 3
#: Ticks between two reports of progress.
REPORT_EVERY = 1000


def run(plant: Plant, references: References, progress: Progress | None = None) -> States:
    """An axis under its drive along references.

    One that MuJoCo runs natively does so; if it reaches its torque limit, where the drive stops its integrator and
    MuJoCo's does not, it runs again tick by tick. InputError where the references' period is not the drive's,
    SimulationError where the simulation diverged.
    """
    period, limit = plant.cascade.control_period, plant.cascade.torque_limit
    if abs(references.period / period - 1.0) > 1e-6:
        raise InputError("references", f"found a period of {references.period:g} s", f"allowed: {period:g} s")
    with silenced():
        states = run_native(plant.native_loop(references)) if plant.native else None
        if states is None or (np.abs(states.torque) >= limit).any():
            states = run_ticked(plant.ticked_loop(references), progress)
    if states.diverged:
        raise SimulationError(DIVERGED)
    if progress is not None:
        progress(1.0)
    return states


def run_loops(loops: Sequence[ClosedLoop]) -> list[States]:
    """Motion of each loop of planned inputs, a step a tick, nan where it diverged.

    Native ones run on all cores, others of the same effects and ticks side by side.
    """
    groups: dict[Hashable, list[int]] = {}
    for index, loop in enumerate(loops):
        names = (tuple(present.name for present in those) for those in (loop.axis.native, loop.axis.ticked))
        groups.setdefault(loop.native or (loop.ticks, loop.every, loop.compiled.opt.timestep, *names), []).append(index)
    found: dict[int, States] = {}
    with silenced():
        for indices in groups.values():
            group = [loops[index] for index in indices]
            found |= zip(indices, _run_alike(group), strict=True)
    return [found[index] for index in range(len(loops))]


def _run_alike(loops: Sequence[ClosedLoop]) -> Iterable[States]:
    """Those of one group."""
    if loops[0].native:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(run_native, loops))
    return run_side_by_side(loops) if len(loops) >= MANY else map(run_ticked, loops)


def run_native(loop: ClosedLoop) -> States:
    """Motion of one axis that MuJoCo runs by itself, nan from where it diverged.

    It runs in blocks, the same to the last bit as in one rollout: each takes up the state of the one before. MuJoCo's
    warnings are the caller's to silence, once for all threads.
    """
    assert not isinstance(loop.controller, CascadeDrive)
    model, data, every = loop.compiled, mujoco.MjData(loop.compiled), loop.every
    half, joint, first = model.opt.timestep / 2.0, model.joint(AXIS), model.actuator_ctrladr[model.actuator(DRIVE).id]
    data.qpos[joint.qposadr[0]], data.qvel[joint.dofadr[0]] = loop.position + half * loop.velocity, loop.velocity
    state = np.empty((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    mujoco.mj_getState(model, data, state[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
    links = _links(model)
    qpos, qvel, torque = 1 + joint.qposadr[0], 1 + model.nq + joint.dofadr[0], model.sensor(TORQUE).adr[0]
    time = loop.time[::every]
    found = np.full((3, time.size), np.nan)
    for start, stop in _blocks(loop, 8 * (model.nu + state.size + model.nsensordata)):
        *held, effort, known = loop.controller(start, stop).T
        planned, inputs = np.column_stack([*held, effort - known]), np.zeros((1, stop - start, model.nu))
        inputs[0, :, first : first + planned.shape[1]] = planned
        inputs[0, :, links] = known[:, None]
        # where the solver starts its search is no part of the state, but of the last bits of the result
        warm = data.qacc_warmstart[None].copy()
        after, sensors = rollout.rollout([model], [data], state, inputs, initial_warmstart=warm)
        if after[0, -1, 0] < (stop - 0.5) * model.opt.timestep or not np.isfinite(after).all():
            break
        position, velocity = (np.append(state[0, at], after[0, :-1, at]) for at in (qpos, qvel))
        rows, recorded = slice(-start % every, None, every), slice(-(-start // every), -(-stop // every))
        found[:, recorded] = np.stack([position - half * velocity, velocity, sensors[0, :, torque]])[:, rows]
        state = after[:, -1].copy()
    return States(time, found[0], found[1], found[2], found[2])


def run_ticked(loop: ClosedLoop, progress: Progress | None = None) -> States:
    """The same tick by tick, in numbers, where the drive's law or an effect is Python; nan where it diverged."""
    axis, every = _TickedAxis(loop), loop.every
    position, velocity, torque, motor_torque = recorded = np.zeros((4, -(-loop.ticks // every)))
    for k, time in enumerate(loop.time.tolist()):
        found = axis.tick(k, time)
        if k % every == 0:
            row = k // every
            position[row], velocity[row], torque[row], motor_torque[row] = found
        if progress is not None and k % REPORT_EVERY == 0:
            progress(k / loop.ticks)
    if axis.data.warning.number.any():
        recorded[:] = np.nan
    return States(loop.time[::every], *recorded)


def run_side_by_side(loops: Sequence[ClosedLoop]) -> list[States]:
    """The same of loops with planned inputs, the same effects and the same ticks, all of them in each step."""
    first, batch = loops[0], _batch_of(loops)
    model, every = first.compiled, first.every
    joint, actuator, half = model.joint(AXIS), model.actuator(DRIVE).id, model.opt.timestep / 2.0
    dof, inputs = int(joint.dofadr[0]), slice(model.actuator_ctrladr[actuator], None)
    position, velocity = batch.bind("qpos")[:, joint.qposadr[0]], batch.bind("qvel")[:, dof]
    applied, setpoints = batch.bind("qfrc_applied")[:, dof], batch.bind("ctrl")[:, inputs]
    effort, links = setpoints[:, model.actuator_ctrlnum[actuator] - 1], batch.bind("ctrl")[:, _links(model)]
    bristles = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, BRISTLES)
    level, armature = batch.expand("dof_frictionloss")[:, dof : dof + 1], batch.expand("dof_armature")[:, dof]
    if bristles >= 0:
        level = batch.expand("actuator_biasprm")[:, bristles, BRISTLE_LEVELS]
    start, velocity[:], since, began = np.array([(o.position, o.velocity, o.since, o.began) for o in loops]).T
    position[:], bare = start + half * velocity, armature.copy()
    effects = SteppedEffects([loop.axis for loop in loops], model.opt.timestep, bristles >= 0)
    memory, found = effects.start(velocity.copy()), np.empty((4, -(-first.ticks // every), len(loops)))
    controllers = [loop.controller for loop in loops if not isinstance(loop.controller, CascadeDrive)]
    for k, planned in enumerate(_planned(controllers, first)):
        here, speed, motor = position.copy(), velocity.copy(), planned[:, -2]
        acts = effects.act(memory, since + first.time[k], here, speed, motor, began)
        flows, acting, applied[:], friction, inertia, memory = acts
        if friction is not None:
            level[:] = friction[:, None]
        if inertia is not None:
            armature[:] = bare + inertia
        setpoints[:, : planned.shape[1] - 2], effort[:] = planned[:, :-2], acting - planned[:, -1]
        links[:] = planned[:, -1:]
        batch.step()
        if k % every == 0:
            found[:, k // every] = here - half * speed, speed, flows, acting
    found[:, :, batch.bind("time") < 2.0 * half * (first.ticks - 0.5)] = np.nan
    return [States(first.time[::every], *signals) for signals in found.transpose(2, 0, 1)]


def _links(model: mujoco.MjModel) -> slice:
    """Where the known torque on a load behind a coupling is among the inputs: one place, or none."""
    actuator = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, LINKS)
    at = model.actuator_ctrladr[actuator] if actuator >= 0 else 0
    return slice(at, at + (actuator >= 0))


def _batch_of(loops: Sequence[ClosedLoop]) -> Batch:
    """Simulations of the models of loops, which differ in numbers alone."""
    models = [loop.compiled for loop in loops]
    batch = Batch(models[0], len(models), 1)
    for name in MODEL_FIELDS if any(model is not models[0] for model in models) else ():
        values = [*map(attrgetter(name), models)]
        if any(not np.array_equal(value, values[0]) for value in values):
            batch.expand(name)[:] = values
    return batch


class _TickedAxis:
    """An axis that goes on tick by tick.

    Attributes:
        data: MuJoCo's.
    """

    def __init__(self, loop: ClosedLoop) -> None:
        self._model = model = copy(loop.compiled)  # effects write to it
        self.data = data = mujoco.MjData(model)
        joint, actuator = model.joint(AXIS), model.actuator(DRIVE).id
        at, inputs = model.actuator_ctrladr[actuator], model.actuator_ctrlnum[actuator]
        dof, bristles = int(joint.dofadr[0]), mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, BRISTLES)
        self._position, self._velocity = data.qpos[joint.qposadr[0] :], data.qvel[dof:]
        self._setpoints, self._effort = data.ctrl[at : at + inputs - 1], data.ctrl[at + inputs - 1 :]
        self._links = data.ctrl[_links(model)]
        self._applied, self._armature = data.qfrc_applied[dof:], model.dof_armature[dof:]
        self._level = model.dof_frictionloss[dof : dof + 1]
        if bristles >= 0:
            self._level = model.actuator_biasprm[bristles, BRISTLE_LEVELS]
        self._step, self._substeps, self._bare = model.opt.timestep, loop.substeps, float(self._armature[0])
        self._velocity[0], self._position[0] = loop.velocity, loop.position + self._step / 2.0 * loop.velocity
        if isinstance(loop.controller, CascadeDrive):
            self._drive, self._planned = loop.controller, iter(())
        else:
            self._drive, self._planned = None, _planned_of(loop.controller, loop)
        self._since, self._began = loop.since, loop.began
        self._effects = None if loop.axis.all_native else SteppedEffects([loop.axis], self._step, bristles >= 0)
        self._memory = self._effects and self._effects.start(loop.velocity)

    def tick(self, k: int, time: float) -> tuple[float, float, float, float]:
        """Go on by a tick, the next one, which starts at a time - s.

        Returns position and velocity at it - rad (m), rad/s (m/s) - and efforts to the next - N*m (N): that is reported
        and that the motor makes, means over its steps.
        """
        here, velocity = self._position.item(0), self._velocity.item(0)
        position, known = here - self._step / 2.0 * velocity, 0.0
        if self._drive is None:
            *self._setpoints[:], motor, known = next(self._planned)
            setpoint = motor
        else:
            setpoint, motor = self._drive.tick(k, position, velocity)
        flowing, acting = self._step_on(time, here, velocity, motor, known)
        for substep in range(1, self._substeps):
            now = self._position.item(0), self._velocity.item(0)
            flows, acts = self._step_on(time + substep * self._step, *now, motor, known)
            flowing, acting = flowing + flows, acting + acts
        return position, velocity, setpoint + (flowing / self._substeps - motor), acting / self._substeps

    def _step_on(
        self, time: float, position: float, velocity: float, motor: float, known: float
    ) -> tuple[float, float]:
        """One step from a state, less a known torque: effort that flows, and acts."""
        flows = acting = motor
        if self._effects is not None and self._memory is not None:
            acts = self._effects.act(self._memory, self._since + time, position, velocity, motor, self._began)
            flows, acting, self._applied[0], friction, inertia, self._memory = acts
            if friction is not None:
                self._level[:] = friction
            if inertia is not None:
                self._armature[0] = self._bare + inertia
        self._effort[0], self._links[:] = acting - known, known
        mujoco.mj_step(self._model, self.data)
        return flows, acting


def _planned_of(controller: PlannedInputs, loop: ClosedLoop) -> Iterator[list[float]]:
    """Those of a lone loop, in numbers."""
    for start, stop in _blocks(loop, 256):
        yield from controller(start, stop).tolist()


def _planned(controllers: Sequence[PlannedInputs], loop: ClosedLoop) -> Iterator[Array]:
    """Planned set-points, effort and known torque of loops (loops, inputs) at each tick."""
    for start, stop in _blocks(loop, 64 * len(controllers)):
        yield from np.stack([planned(start, stop) for planned in controllers], axis=1)


def _blocks(loop: ClosedLoop, bytes_per_tick: int) -> Iterator[tuple[int, int]]:
    """First tick of each block and the one after its last."""
    size = max(1, loop.block_bytes // bytes_per_tick)
    return ((start, min(start + size, loop.ticks)) for start in range(0, loop.ticks, size))
