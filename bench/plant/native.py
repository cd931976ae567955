"""One axis in one rollout in C, its drive being MuJoCo's own actuator."""

from __future__ import annotations

import os
from collections.abc import Sequence

import mujoco
import numpy as np
from mujoco import rollout

from bench.arrays import Array
from bench.effects.mjcf import AXIS, DRIVE
from bench.errors import SimulationError
from bench.plant.drive import add_pid, pid_controls
from bench.plant.plant import Plant
from bench.plant.quiet import quiet
from bench.plant.references import References
from bench.plant.states import DIVERGED, States


def run_native(plant: Plant, references: References) -> States:
    """One axis with its drive as MuJoCo's `pid`, in one rollout; its integrator does not hold while limited."""
    spec = plant.spec()
    add_pid(spec, plant.cascade)
    sense_torque(spec)
    controls = pid_controls(plant.cascade, references)
    return run_controls(spec.compile(), controls, references.position[0], references.velocity[0])


def sense_torque(spec: mujoco.MjSpec) -> None:
    """Let a model report the torque of its drive, as the sensor `torque`."""
    kind, actuator = mujoco.mjtSensor.mjSENS_ACTUATORFRC, mujoco.mjtObj.mjOBJ_ACTUATOR
    spec.add_sensor(name="torque", type=kind, objtype=actuator, objname=DRIVE)


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
    (run,) = run_side_by_side([model], controls[None], np.array([[position, velocity]]))
    if run is None:
        raise SimulationError(DIVERGED)
    return States.of_one(np.arange(controls.shape[0]) * model.opt.timestep, *run)


def run_side_by_side(
    models: Sequence[mujoco.MjModel], controls: Array, start: Array
) -> list[tuple[Array, Array, Array] | None]:
    """Open loop, as `run_controls`, of several models of one structure, on as many threads as there are processors.

    Args:
        models: of one axis each.
        controls: (k, steps, inputs), held from each step to the next.
        start: position - rad (m) - and velocity - rad/s (m/s) - (k, 2).

    Returns:
        Position, velocity and torque of each, (steps,); None where one diverged.
    """
    model, (count, steps, width) = models[0], controls.shape
    half = model.opt.timestep / 2.0
    joint, first = model.joint(AXIS), model.actuator_ctrladr[model.actuator(DRIVE).id]
    inputs = np.zeros((count, steps, model.nu))
    inputs[:, :, first : first + width] = controls
    states = np.empty((count, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    for each, (position, velocity), state in zip(models, start, states, strict=True):
        data = mujoco.MjData(each)
        data.qpos[joint.qposadr[0]], data.qvel[joint.dofadr[0]] = position + half * velocity, velocity
        mujoco.mj_getState(each, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    workers = [mujoco.MjData(model) for _ in range(min(count, os.cpu_count() or 1))]
    with quiet():
        after, sensors = rollout.rollout(list(models), workers, states, inputs)
    before = np.concatenate([states[:, None], after[:, :-1]], axis=1)
    torque = sensors[:, :, model.sensor("torque").adr[0]]
    qpos, qvel = before[:, :, 1 + joint.qposadr[0]], before[:, :, 1 + model.nq + joint.dofadr[0]]
    sound = (after[:, -1, 0] >= (steps - 0.5) * model.opt.timestep) & np.isfinite(after).all(axis=(1, 2))
    return [(qpos[i] - half * qvel[i], qvel[i], torque[i]) if sound[i] else None for i in range(count)]
