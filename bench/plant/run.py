"""Run axes: those that MuJoCo runs by itself natively in C, the others tick by tick, side by side on a batch."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from copy import copy

import mujoco
import numpy as np
from mujoco import rollout
from mujoco.batch import MODEL_FIELDS, Batch
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.mjcf import AXIS, DRIVE
from bench.effects.signals import Number
from bench.errors import InputError, SimulationError
from bench.plant.drive import TORQUE, CascadeDrive, FollowReferences, References, by_ticks
from bench.plant.plant import DIVERGED, ClosedLoop, Plant, States
from bench.plant.silenced import silenced
from bench.plant.simulations import Joints, Simulations
from bench.plant.stepped_effects import SteppedEffects, per_axis

Progress = Callable[[float], None]

#: Bytes of inputs and states that a simulation holds at once, however long it is.
BLOCK_BYTES = 8 * 2**20
#: Axes from which it pays to share a step between threads: calling them costs some 10 to 50 us, an axis 2 to 4.
SHARED_FROM = 64
#: Axes from which arrays of all of them take less time than the numbers of each in turn.
TOGETHER_FROM = 5
#: Ticks between two reports of progress.
REPORT_EVERY = 1000


def run(plants: Sequence[Plant], references: Sequence[References], progress: Progress | None = None) -> States:
    """Axes under their drives along their references, one each, all over the same ticks.

    Axes that MuJoCo runs natively do so; if one reaches its torque limit, where the drive holds its integrator and
    MuJoCo's does not, it runs again with the others, tick by tick.

    Raises:
        InputError: references of another period than the drive's, or drives of different periods.
        SimulationError: a simulation diverged.
    """
    period = plants[0].cascade.control_period
    for plant, reference in zip(plants, references, strict=True):
        if plant.cascade.control_period != period or plant.timestep != plants[0].timestep:
            raise InputError("drive.control_period", "found different periods", "allowed: axes that tick together")
        if abs(reference.period / period - 1.0) > 1e-6:
            raise InputError("references", f"found a period of {reference.period:g} s", f"allowed: {period:g} s")
    same = {plant: plant for plant in plants}
    pairs = [(same[plant], motion) for plant, motion in zip(plants, references, strict=True)]
    native = {k: plant.native_loop(motion) for k, (plant, motion) in enumerate(pairs) if plant.native}
    found = dict(zip(native, run_loops([*native.values()]), strict=True))
    limited = {k for k in found if (np.abs(found[k].torque) >= pairs[k][0].cascade.torque_limit).any()}
    ticked = {k: pairs[k][0].ticked_loop(pairs[k][1]) for k in range(len(pairs)) if k not in found or k in limited}
    found |= zip(ticked, run_loops([*ticked.values()], progress), strict=True)
    if any(states.diverged for states in found.values()):
        raise SimulationError(DIVERGED)
    if progress is not None:
        progress(1.0)
    signals = zip(*(found[k].signals for k in range(len(pairs))), strict=True)
    return States(found[0].time, *(np.concatenate(signal, axis=1) for signal in signals))


def run_loops(loops: Sequence[ClosedLoop], progress: Progress | None = None) -> list[States]:
    """Motion of each loop at its own ticks, nan where it diverged.

    Native ones run on all cores, the others tick by tick: several that are alike side by side,
    which costs hardly more than one, few of them in turn.
    """
    alike = defaultdict[object, list[int]](list)
    for k, loop in enumerate(loops):
        alike["native" if loop.native else loop.alike].append(k)
    native = alike.pop("native", [])
    with silenced():
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            found = dict(zip(native, pool.map(run_native, (loops[k] for k in native)), strict=True))
        for group in alike.values():
            for part in [group] if len(group) >= TOGETHER_FROM else [[k] for k in group]:
                together = run_ticked([loops[k] for k in part], progress)
                for column, k in enumerate(part):
                    found[k] = together.axis(column, -(-loops[k].ticks // loops[k].every))
    return [found[k] for k in range(len(loops))]


def run_native(loop: ClosedLoop) -> States:
    """Motion of one axis that MuJoCo runs by itself, nan from where it diverged.

    It runs in blocks, the same to the last bit as in one rollout: each takes up the state of the one before. MuJoCo's
    warnings are the caller's to silence, once for all threads.
    """
    assert not isinstance(loop.controller, FollowReferences)
    model, data, every = loop.compiled, mujoco.MjData(loop.compiled), loop.every
    half, joint, first = model.opt.timestep / 2.0, model.joint(AXIS), model.actuator_ctrladr[model.actuator(DRIVE).id]
    data.qpos[joint.qposadr[0]], data.qvel[joint.dofadr[0]] = loop.position + half * loop.velocity, loop.velocity
    state = np.empty((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    mujoco.mj_getState(model, data, state[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
    qpos, qvel, torque = 1 + joint.qposadr[0], 1 + model.nq + joint.dofadr[0], model.sensor(TORQUE).adr[0]
    time = loop.time[::every]
    found = np.full((3, time.size, 1), np.nan)
    for start, stop in _blocks(loop.ticks, 8 * (model.nu + state.size + model.nsensordata)):
        *held, effort, known = loop.controller(start, stop).T
        planned, inputs = np.column_stack([*held, effort - known]), np.zeros((1, stop - start, model.nu))
        inputs[0, :, first : first + planned.shape[1]] = planned
        # where the solver starts its search is no part of the state, but of the last bits of the result
        warm = data.qacc_warmstart[None].copy()
        after, sensors = rollout.rollout([model], [data], state, inputs, initial_warmstart=warm)
        if after[0, -1, 0] < (stop - 0.5) * model.opt.timestep or not np.isfinite(after).all():
            break
        position, velocity = (np.append(state[0, at], after[0, :-1, at]) for at in (qpos, qvel))
        rows, recorded = slice(-start % every, None, every), slice(-(-start // every), -(-stop // every))
        found[:, recorded, 0] = np.stack([position - half * velocity, velocity, sensors[0, :, torque]])[:, rows]
        state = after[:, -1].copy()
    return States(time, found[0], found[1], found[2], found[2])


def run_ticked(loops: Sequence[ClosedLoop], progress: Progress | None = None) -> States:
    """Motion of axes side by side, nan where one diverged; the same arithmetic for one axis and a thousand.

    Loops are alike, as `ClosedLoop.alike` has it, and run as long as the longest. MuJoCo's warnings are the caller's to
    silence.
    """
    axes, every = _Axes(loops), loops[0].every
    time = max((loop.time for loop in loops), key=len)
    recorded = States(time[::every], *np.zeros((4, -(-time.size // every), len(loops))))
    for k in range(time.size):
        found = axes.tick(k, time[k])
        if k % every == 0:
            for signal, values in zip(recorded.signals, found, strict=True):
                signal[k // every] = values
        if progress is not None and k % REPORT_EVERY == 0:
            progress(k / time.size)
    recorded.velocity[:, axes.diverged] = np.nan
    return recorded


class _Axes:
    """Axes that go on tick by tick: a lone one in numbers, several side by side in arrays (axes,)."""

    def __init__(self, loops: Sequence[ClosedLoop]) -> None:
        compiled, axes = [loop.compiled for loop in loops], [loop.axis for loop in loops]
        self._lone = len(loops) == 1
        if self._lone:
            model = copy(compiled[0])  # effects write to it
            simulations = Simulations.lone(model, data := mujoco.MjData(model))
            self._warned = lambda: np.array([any(data.warning.number)])
        else:
            batch = batch_of(compiled)
            simulations = Simulations.of(batch)
            self._warned = lambda: np.any(np.reshape(batch.warning, (batch.nsim, -1)), axis=1)
        model, state = simulations.model, simulations.state
        joint, actuator = model.joint(AXIS), model.actuator(DRIVE).id
        self._step, self._substeps, self._advance = model.opt.timestep, loops[0].substeps, simulations.advance
        self._position, self._velocity = state("qpos")[:, joint.qposadr[0]], state("qvel")[:, joint.dofadr[0]]
        self._velocity[:] = [loop.velocity for loop in loops]
        self._position[:] = np.array([loop.position for loop in loops]) + self._step / 2.0 * self._velocity
        at = model.actuator_ctrladr[actuator]
        inputs = state("ctrl")[:, at : at + model.actuator_ctrlnum[actuator]]
        self._setpoints, self._effort = inputs[:, :-1], inputs[:, -1]
        drives = [loop.controller for loop in loops if isinstance(loop.controller, FollowReferences)]
        self._drive = CascadeDrive.of(drives, axes) if drives else None
        self._planned = _planned(loops, inputs.shape[1] + 1)
        self._since, self._began = (per_axis([getattr(loop, name) for loop in loops]) for name in ("since", "began"))
        self._effects = None
        if not all(axis.all_native for axis in axes):
            self._joints = Joints(simulations)
            self._effects = SteppedEffects(axes, self._step, bool(self._joints.bristled.any()))
            self._memory = self._effects.start(self._state()[1])

    def tick(self, k: int, time: float) -> tuple[Number, Number, Number, Number]:
        """Go on by a tick, the next one, which starts at a time - s.

        Returns position and velocity at it - rad (m), rad/s (m/s) - and efforts to the next - N*m (N): that is reported
        and that the motor makes, means over its steps. (axes,) each, or numbers of a lone axis.
        """
        here, velocity = self._state()
        position = here - self._step / 2.0 * velocity
        setpoint, motor, known = self._asked(k, position, velocity)
        if self._effects is None:
            self._effort[:] = motor - known
            for _ in range(self._substeps):
                self._advance()
            return position, velocity, setpoint, motor
        flowing, acting = self._step_on(time, here, velocity, motor, known)
        for substep in range(1, self._substeps):
            flows, acts = self._step_on(time + substep * self._step, *self._state(), motor, known)
            flowing, acting = flowing + flows, acting + acts
        return position, velocity, setpoint + (flowing / self._substeps - motor), acting / self._substeps

    def _state(self) -> tuple[Number, Number]:
        """MuJoCo's position and velocity as they are now."""
        if self._lone:
            return self._position.item(), self._velocity.item()
        return self._position.copy(), self._velocity.copy()

    def _asked(self, k: int, position: Number, velocity: Number) -> tuple[Number, Number, Number]:
        """Effort from a tick to the next that is reported, asked of the motor, and known to resist beside."""
        if self._drive is not None:
            return *self._drive.tick(k, position, velocity), 0.0
        self._setpoints[:], effort, known = next(self._planned)
        return effort, effort, known

    def _step_on(
        self, time: float, position: Number, velocity: Number, motor: Number, known: Number
    ) -> tuple[Number, Number]:
        """One step from a state: effort that flows, and acts."""
        assert self._effects is not None
        acts = self._effects.act(self._memory, self._since + time, position, velocity, motor, self._began)
        self._memory, self._effort[:] = acts.memory, acts.motor - known
        self._joints.take(acts)
        self._advance()
        return acts.reported, acts.motor

    @property
    def diverged(self) -> NDArray[np.bool_]:
        """Of which axes MuJoCo warned - (axes,)."""
        return self._warned()


def _blocks(ticks: int, bytes_per_tick: int) -> Iterator[tuple[int, int]]:
    """First tick of each block and the one after its last."""
    size = max(1, BLOCK_BYTES // bytes_per_tick)
    return ((start, min(start + size, ticks)) for start in range(0, ticks, size))


def _planned(loops: Sequence[ClosedLoop], inputs: int) -> Iterator[tuple[Array, Number, Number]]:
    """Planned set-points (axes, inputs - 2), effort and known torque at each tick of the longest loop.

    After the end of a loop its last are held.
    """
    for start, stop in _blocks(max(loop.ticks for loop in loops), 8 * inputs * len(loops)):
        held = []
        for loop in loops:
            assert not isinstance(loop.controller, FollowReferences)
            first = min(start, loop.ticks - 1)
            known = loop.controller(first, min(stop, loop.ticks))
            held.append(known[np.minimum(np.arange(start, stop), loop.ticks - 1) - first])
        *setpoints, effort, known = np.moveaxis(np.stack(held, axis=1), -1, 0)
        yield from zip(np.stack(setpoints, axis=-1), by_ticks(effort), by_ticks(known), strict=True)


def batch_of(models: Sequence[mujoco.MjModel]) -> Batch:
    """A batch with one simulation per model; fields in which the models differ become per-simulation ones."""
    batch = Batch(models[0], len(models), nthread=1 if len(models) < SHARED_FROM else 0)
    distinct = list({id(model): model for model in models}.values())
    for name in sorted(MODEL_FIELDS):
        if len(distinct) > 1 and not name.startswith("opt."):
            values = {id(model): getattr(model, name) for model in distinct}
            if any(not np.array_equal(value, values[id(models[0])]) for value in values.values()):
                batch.expand(name)[:] = np.stack([values[id(model)] for model in models])
    return batch
