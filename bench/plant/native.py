"""The native runner: one axis in rollouts in C, its controller being MuJoCo's own actuator."""

from __future__ import annotations

import mujoco
import numpy as np
from mujoco import rollout

from bench.effects.mjcf import AXIS, DRIVE
from bench.plant.closed_loop import ClosedLoop, PlannedInputs, States, blocks

#: Sensor that has to be in a model that runs natively.
TORQUE = "torque"


def sense_torque(spec: mujoco.MjSpec) -> None:
    """Let a model report the torque of its drive."""
    kind, actuator = mujoco.mjtSensor.mjSENS_ACTUATORFRC, mujoco.mjtObj.mjOBJ_ACTUATOR
    spec.add_sensor(name=TORQUE, type=kind, objtype=actuator, objname=DRIVE)


def run_native(loop: ClosedLoop) -> States:
    """Motion of one axis that MuJoCo runs by itself, nan from where it diverged.

    It runs in blocks, the same to the last bit as in one rollout: each takes up the state of the one before. MuJoCo's
    warnings are the caller's to silence, once for all threads.
    """
    assert isinstance(loop.controller, PlannedInputs)
    model, data, every = loop.compiled, mujoco.MjData(loop.compiled), loop.every
    half, joint, first = model.opt.timestep / 2.0, model.joint(AXIS), model.actuator_ctrladr[model.actuator(DRIVE).id]
    data.qpos[joint.qposadr[0]], data.qvel[joint.dofadr[0]] = loop.position + half * loop.velocity, loop.velocity
    state = np.empty((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    mujoco.mj_getState(model, data, state[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
    qpos, qvel, torque = 1 + joint.qposadr[0], 1 + model.nq + joint.dofadr[0], model.sensor(TORQUE).adr[0]
    time = loop.time[::every]
    found = np.full((3, time.size), np.nan)
    for start, stop in blocks(loop.ticks, 8 * (model.nu + state.size + model.nsensordata)):
        planned, inputs = loop.controller.between(start, stop), np.zeros((1, stop - start, model.nu))
        inputs[0, :, first : first + planned.shape[1]] = planned
        # where the solver starts its search is no part of the state, but of the last bits of the result
        warm = data.qacc_warmstart[None].copy()
        after, sensors = rollout.rollout([model], [data], state, inputs, initial_warmstart=warm)
        if after[0, -1, 0] < (stop - 0.5) * model.opt.timestep or not np.isfinite(after).all():
            break
        position, velocity = (np.append(state[0, at], after[0, :-1, at]) for at in (qpos, qvel))
        rows, recorded = slice(-start % every, None, every), slice(-(-start // every), -(-stop // every))
        found[:, recorded] = np.stack([position - half * velocity, velocity, sensors[0, :, torque]])[:, rows]
        state = after[:, -1].copy()
    return States.of_one(time, *found)
