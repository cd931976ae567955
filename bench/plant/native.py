"""One axis in one rollout in C, its drive being MuJoCo's own actuator."""

from __future__ import annotations

import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray

from bench.effects.mjcf import AXIS, DRIVE
from bench.errors import SimulationError
from bench.plant.drive import add_pid, pid_controls
from bench.plant.plant import Plant
from bench.plant.quiet import quiet
from bench.plant.references import References
from bench.plant.states import DIVERGED, States

Array = NDArray[np.float64]


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
    """
    data, steps = mujoco.MjData(model), controls.shape[0]
    half = model.opt.timestep / 2.0
    joint, actuator = model.joint(AXIS), model.actuator(DRIVE).id
    data.qpos[joint.qposadr[0]], data.qvel[joint.dofadr[0]] = position + half * velocity, velocity
    inputs = np.zeros((steps, model.nu))
    first = model.actuator_ctrladr[actuator]
    inputs[:, first : first + controls.shape[1]] = controls
    start = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    with quiet():
        after, sensors = rollout.rollout(model, data, start, inputs)
    before = np.concatenate([start[None], after[0, :-1]])
    if after[0, -1, 0] < (steps - 0.5) * model.opt.timestep:
        raise SimulationError(DIVERGED)
    qpos, qvel = before[:, 1 + joint.qposadr[0]], before[:, 1 + model.nq + joint.dofadr[0]]
    torque = sensors[0][:, model.sensor("torque").adr[0]]
    return States.of_one(np.arange(steps) * model.opt.timestep, qpos - half * qvel, qvel, torque)
