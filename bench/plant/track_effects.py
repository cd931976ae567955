"""Hold an axis with effects softly to a recording: its velocity against the recorded one is the velocity gap.

As `bench.plant.track`, with every effect where it acts: electronics on the recorded effort before the simulation,
mechanisms in MuJoCo (one rollout where all of them are native, else step by step), sensing on what comes out. What
holds the model is the true motion as far as the recording tells it: sensing is undone on the set-points, or the model
would be pulled after the sensor's errors.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.effects.mjcf import AXIS, DRIVE
from bench.effects.physics import Electronics, Mechanism
from bench.errors import SimulationError
from bench.plant.axis_model import AxisModel
from bench.plant.native import run_controls
from bench.plant.quiet import quiet
from bench.plant.sensing import reported, true_motion, true_velocity
from bench.plant.states import DIVERGED
from bench.plant.ticked import TickedEffects
from bench.plant.ticks import batch_of
from bench.plant.track import (
    BANDWIDTH,
    holding_cascade,
    holding_controls,
    holding_model,
    integrated,
    measured_velocity,
    step_of,
)
from bench.trace.trace import Trace

Array = NDArray[np.float64]


def track_effects(
    model: AxisModel, trace: Trace, effort: Array, misalignment: float = 0.0, bandwidth: float = BANDWIDTH
) -> Array:
    """Velocity that an axis with effects reports, held to a recording - rad/s (m/s) - (n,).

    Each stretch without holes is started from the recording; time of effects counts from the recording's start.

    Args:
        model: with effects.
        trace: the recording, with velocity or position.
        effort: (n,) torque - N*m (force - N) that the rig makes of it.
        misalignment: by how much the effort is reported late - s.
        bandwidth: of the cascade that holds the model - rad/s.

    Raises:
        SimulationError: the model diverged.
    """
    timestep, _ = step_of(trace)
    compiled = holding_model(model.spec(timestep), holding_cascade(model.parameters.inertia, timestep, bandwidth))
    velocity, simulated = measured_velocity(trace), np.empty(len(trace))
    for part in trace.segments:
        seen = true_velocity(model, velocity[part], trace.sample_period)
        position = trace["position"][part] if "position" in trace else integrated(seen, trace.sample_period)
        motion = true_motion(model, position, seen)
        controls, substeps = holding_controls(timestep, trace.time[part], *motion, effort[part], misalignment)
        controls[:, 2] = acting_effort(model, controls[:, 2], timestep)
        start = (motion[0][0], motion[1][0])
        if model.ticked:
            result = _run_ticked(compiled, model, controls, start, float(trace.time[part][0] - trace.time[0]))
        else:
            states = run_controls(compiled, controls, *start)
            result = states.position[:, 0], states.velocity[:, 0]
        simulated[part] = reported(model, *result, timestep)[1][::substeps]
    return simulated


def acting_effort(model: AxisModel, effort: Array, step: float) -> Array:
    """Torque that the motor makes of a reported effort, (n,) at a constant step - N*m (N)."""
    electronics = [(p.effect, dict(p.values)) for p in model.of_kind(Electronics)]
    for effect, values in electronics:
        assert isinstance(effect, Electronics)
        effort = effect.acting_along(values, effort, step)
    for effect, values in electronics:
        assert isinstance(effect, Electronics)
        effort = effect.delivered(values, model.axis, effort)
    return effort


def _run_ticked(
    compiled: mujoco.MjModel, model: AxisModel, controls: Array, start: tuple[float, float], time: float
) -> tuple[Array, Array]:
    """Position and velocity at every step, (steps,) each, of an axis whose effects act in every step."""
    batch, half = batch_of([compiled]), compiled.opt.timestep / 2.0
    joint, first = compiled.joint(AXIS), compiled.actuator_ctrladr[compiled.actuator(DRIVE).id]
    position = batch.bind("qpos")[:, joint.qposadr[0]]
    velocity = batch.bind("qvel")[:, joint.dofadr[0]]
    inputs = batch.bind("ctrl")[:, first : first + controls.shape[1]]
    position[:], velocity[:] = start[0] + half * start[1], start[1]
    acting = TickedEffects(batch, [model.with_effects(model.of_kind(Mechanism))], velocity)
    record = np.empty((2, controls.shape[0]))
    with quiet():
        for k, control in enumerate(controls):
            record[0, k], record[1, k] = position[0] - half * velocity[0], velocity[0]
            inputs[:] = control
            inputs[:, 2] = acting.act(time + k * 2.0 * half, position, velocity, control[2:])[1]
            batch.step()
    if batch.warning.any() or not np.isfinite(record).all():
        raise SimulationError(DIVERGED)
    return record[0], record[1]
