"""Hold a model softly to a recording: what it does differently is the velocity gap.

The recorded effort drives the model as feed-forward; measured position and velocity are set-points of one weak
cascade, which keeps the model near the recording where integration alone would drift away. It needs no references and
no drive data. Its bandwidth decides what is seen: a difference in torque of frequency well above it shows in full, one
well below it is held down. State it beside every velocity gap.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np

from bench.arrays import Array
from bench.errors import SimulationError
from bench.plant.drive import Cascade, add_pid
from bench.plant.native import run_controls, sense_torque
from bench.trace.trace import Trace

#: Bandwidth of the cascade that holds the model - rad/s.
BANDWIDTH = 10.0
#: Longest step of the integration - s.
LONGEST_STEP = 0.5e-3


def holding_cascade(inertia: float, timestep: float, bandwidth: float = BANDWIDTH) -> Cascade:
    """Cascade of a bandwidth w - rad/s - for an inertia J - kg*m**2 (kg): K_v = J*w, K_i = J*w**2/6, K_p = w/5.

    With them the loop J*s + K_v + K_i/s has its zero a sixth, its position loop a fifth of the bandwidth below it.
    """
    return Cascade(
        position_gain=bandwidth / 5.0,
        velocity_gain=inertia * bandwidth,
        integral_gain=inertia * bandwidth**2 / 6.0,
        inertia_feedforward=0.0,
        torque_limit=math.inf,
        control_period=timestep,
    )


def step_of(trace: Trace) -> tuple[float, int]:
    """Timestep - s - that divides the sample period and is at most LONGEST_STEP, and how many make a period."""
    substeps = math.ceil(trace.sample_period / LONGEST_STEP * (1.0 - 1e-9))
    return trace.sample_period / substeps, substeps


def holding_model(spec: mujoco.MjSpec, cascade: Cascade) -> mujoco.MjModel:
    """Compiled model whose actuator `drive` is the cascade with effort as feed-forward.

    Raises:
        SimulationError: MuJoCo refuses the model, for an inertia too small for one.
    """
    add_pid(spec, cascade)
    sense_torque(spec)
    try:
        return spec.compile()
    except ValueError as error:
        raise SimulationError(f"MuJoCo refuses the model: {str(error).splitlines()[0]}") from error


def track(model: mujoco.MjModel, trace: Trace, effort: Array, misalignment: float = 0.0) -> Array:
    """Velocity of a model held to a recording - rad/s (m/s) - (n,), each stretch started from the recording.

    Args:
        model: of `holding_model`, its timestep from `step_of`.
        trace: the recording, with velocity or position.
        effort: (n,) torque - N*m (force - N) over it.
        misalignment: by how much the effort is reported late - s.

    Raises:
        SimulationError: the model diverged.
    """
    velocity = measured_velocity(trace)
    simulated = np.empty_like(velocity)
    for part in trace.segments:
        position = trace["position"][part] if "position" in trace else integrated(velocity[part], trace.sample_period)
        simulated[part] = _track_stretch(model, trace.time[part], position, velocity[part], effort[part], misalignment)
    return simulated


def measured_velocity(trace: Trace) -> Array:
    """Reported velocity, or the central difference of a reported position - rad/s (m/s) - (n,)."""
    if "velocity" in trace:
        return trace["velocity"]
    parts = [np.gradient(trace["position"][part], trace.sample_period) for part in trace.segments]
    return np.concatenate(parts)


def integrated(velocity: Array, sample_period: float) -> Array:
    """Position from zero, by the trapezoidal rule - rad (m) - (n,)."""
    return np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2.0) * sample_period])


def _track_stretch(
    model: mujoco.MjModel, time: Array, position: Array, velocity: Array, effort: Array, misalignment: float
) -> Array:
    controls, substeps = holding_controls(model.opt.timestep, time, position, velocity, effort, misalignment)
    return run_controls(model, controls, position[0], velocity[0]).velocity[::substeps, 0]


def holding_controls(
    timestep: float, time: Array, position: Array, velocity: Array, effort: Array, misalignment: float
) -> tuple[Array, int]:
    """Inputs pos, vel, ff of the actuator of `holding_model` at its steps, (steps, 3), and how many make a sample."""
    substeps = round((time[1] - time[0]) / timestep) if time.size > 1 else 1
    ticks = time[0] + np.arange((time.size - 1) * substeps + 1) * timestep
    wanted = np.interp(ticks, time, velocity)
    # MuJoCo's position belongs half a step later than its velocity, and an input is held over the step it starts.
    lead = np.interp(ticks, time, position) + timestep / 2.0 * wanted
    feedforward = np.interp(ticks + timestep / 2.0 + misalignment, time, effort)
    return np.stack([lead, wanted, feedforward], axis=-1), substeps
