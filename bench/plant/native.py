"""One axis in rollouts in C, its drive being MuJoCo's own actuator."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import rollout

from bench.arrays import Array
from bench.effects.mjcf import AXIS, DRIVE
from bench.errors import SimulationError
from bench.plant.blocks import Controls, blocks
from bench.plant.drive import add_pid, pid_controls
from bench.plant.plant import Plant
from bench.plant.quiet import quiet
from bench.plant.references import References
from bench.plant.states import DIVERGED, States


def run_native(plant: Plant, references: References) -> States:
    """One axis with its drive as MuJoCo's `pid`; its integrator does not hold while limited."""
    spec = plant.spec()
    add_pid(spec, plant.cascade)
    sense_torque(spec)
    controls = pid_controls(plant.cascade, references)
    return run_controls(spec.compile(), controls, references.position[0], references.velocity[0])


def sense_torque(spec: mujoco.MjSpec) -> None:
    """Let a model report the torque of its drive, as the sensor `torque`."""
    kind, actuator = mujoco.mjtSensor.mjSENS_ACTUATORFRC, mujoco.mjtObj.mjOBJ_ACTUATOR
    spec.add_sensor(name="torque", type=kind, objtype=actuator, objname=DRIVE)


@dataclass(frozen=True)
class OpenLoop:
    """An axis under given inputs of its actuator `drive`.

    Attributes:
        model: of one axis, with the sensor `torque`.
        controls: held from each step to the next.
        steps: how many.
        position: to start at - rad (m).
        velocity: to start with - rad/s (m/s).
    """

    model: mujoco.MjModel
    controls: Controls
    steps: int
    position: float
    velocity: float


@dataclass(frozen=True)
class Block:
    """Motion at some consecutive steps, (k,) each.

    Attributes:
        start: number of the first step.
        position: rad (m).
        velocity: rad/s (m/s).
        torque: of the drive, to the next step - N*m (N).
    """

    start: int
    position: Array
    velocity: Array
    torque: Array


def run_controls(model: mujoco.MjModel, controls: Array, position: float, velocity: float) -> States:
    """Open loop: inputs of the actuator `drive`, (steps, inputs), applied to a model with the sensor `torque`.

    Args:
        model: of one axis.
        controls: held from each step to the next.
        position: to start at - rad (m).
        velocity: to start with - rad/s (m/s).

    Raises:
        SimulationError: the model diverged.
    """
    steps = controls.shape[0]
    found = np.empty((3, steps))
    axis = OpenLoop(model, lambda start, stop: controls[start:stop], steps, position, velocity)
    with quiet():
        for block in run_blocks(axis):
            found[:, block.start : block.start + block.velocity.size] = block.position, block.velocity, block.torque
    return States.of_one(np.arange(steps) * model.opt.timestep, *found)


def run_blocks(axis: OpenLoop) -> Iterator[Block]:
    """Motion of an axis, the same to the last bit as in one rollout: each block takes up the state of the one before.

    MuJoCo's warnings are the caller's to silence, once for all threads.

    Raises:
        SimulationError: the model diverged.
    """
    model, data = axis.model, mujoco.MjData(axis.model)
    half, joint, first = model.opt.timestep / 2.0, model.joint(AXIS), model.actuator_ctrladr[model.actuator(DRIVE).id]
    data.qpos[joint.qposadr[0]], data.qvel[joint.dofadr[0]] = axis.position + half * axis.velocity, axis.velocity
    state = np.empty((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    mujoco.mj_getState(model, data, state[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
    qpos, qvel, torque = 1 + joint.qposadr[0], 1 + model.nq + joint.dofadr[0], model.sensor("torque").adr[0]
    for start, stop in blocks(axis.steps, 8 * (model.nu + state.size + model.nsensordata)):
        controls, inputs = axis.controls(start, stop), np.zeros((1, stop - start, model.nu))
        inputs[0, :, first : first + controls.shape[1]] = controls
        # where the solver starts its search is no part of the state, but of the last bits of the result
        warm = data.qacc_warmstart[None].copy()
        after, sensors = rollout.rollout([model], [data], state, inputs, initial_warmstart=warm)
        if after[0, -1, 0] < (stop - 0.5) * model.opt.timestep or not np.isfinite(after).all():
            raise SimulationError(DIVERGED)
        position, velocity = (np.append(state[0, at], after[0, :-1, at]) for at in (qpos, qvel))
        yield Block(start, position - half * velocity, velocity, sensors[0, :, torque])
        state = after[:, -1].copy()
