"""Hold a model softly to a recording: what it does differently is the velocity gap.

The recorded effort drives the model as feed-forward; measured position and velocity are set-points of one weak
cascade, which keeps the model near the recording where integration alone would drift away. It needs no references and
no drive data. Its bandwidth decides what is seen: a difference in torque of frequency well above it shows in full, one
well below it is held down. State it beside every velocity gap.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.errors import SimulationError
from bench.plant.blocks import samples_in
from bench.plant.drive import Cascade, add_pid
from bench.plant.native import OpenLoop, run_blocks, sense_torque
from bench.plant.quiet import quiet
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

    Returns:
        nan outside of `stretches_of`.

    Raises:
        SimulationError: the model diverged.
    """
    timestep, velocity = model.opt.timestep, measured_velocity(trace)
    substeps = round(trace.sample_period / timestep)
    simulated = np.full(len(trace), np.nan)
    for part in stretches_of(trace):
        position = trace["position"][part] if "position" in trace else integrated(velocity[part], trace.sample_period)
        motion = trace.time[part], position, velocity[part]
        inputs = HoldingInputs(*motion, effort[part], timestep, substeps, misalignment)
        samples = simulated[part]
        with quiet():
            for block in run_blocks(OpenLoop(model, inputs, inputs.steps, position[0], velocity[part][0])):
                rows, found = samples_in(block.start, block.start + block.velocity.size, substeps)
                samples[found] = block.velocity[rows]
    return simulated


def stretches_of(trace: Trace) -> tuple[slice, ...]:
    """Stretches without holes that a model can be held to; a lone sample shows no motion."""
    return tuple(part for part in trace.segments if part.stop - part.start > 1)


def in_stretches(trace: Trace) -> NDArray[np.bool_]:
    """Samples at which a model held to a recording says something, (n,): those of `stretches_of`."""
    found = np.zeros(len(trace), dtype=np.bool_)
    for part in stretches_of(trace):
        found[part] = True
    return found


def measured_velocity(trace: Trace) -> Array:
    """Reported velocity, or the central difference of a reported position - rad/s (m/s) - (n,).

    A lone sample between holes has none of its own; it takes the mean speed between its neighbours.
    """
    if "velocity" in trace:
        return trace["velocity"]
    position, velocity = trace["position"], np.empty(len(trace))
    for part in trace.segments:
        if part.stop - part.start > 1:
            velocity[part] = np.gradient(position[part], trace.sample_period)
        else:
            around = [max(part.start - 1, 0), min(part.stop, len(trace) - 1)]
            velocity[part] = np.diff(position[around]) / np.diff(trace.time[around])
    return velocity


def measured_position(trace: Trace) -> Array:
    """Reported position, or the integral of a reported velocity from zero in each stretch - rad (m) - (n,)."""
    if "position" in trace:
        return trace["position"]
    position = np.full(len(trace), np.nan)
    for part in stretches_of(trace):
        position[part] = integrated(trace["velocity"][part], trace.sample_period)
    return position


def integrated(velocity: Array, sample_period: float) -> Array:
    """Position from zero, by the trapezoidal rule - rad (m) - (n,)."""
    return np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2.0) * sample_period])


@dataclass(frozen=True)
class HoldingInputs:
    """Inputs pos, vel, ff of the actuator of `holding_model` along one stretch, read between samples when needed.

    Attributes:
        time: of the samples - s - (n,).
        position, velocity: of the motion that holds the model - rad (m), rad/s (m/s) - (n,).
        effort: that drives it - N*m (N) - (n,).
        timestep: of the model - s.
        substeps: timesteps that make a sample period.
        misalignment: by how much the effort is reported late - s.
    """

    time: Array
    position: Array
    velocity: Array
    effort: Array
    timestep: float
    substeps: int
    misalignment: float

    @property
    def steps(self) -> int:
        """Steps from the first sample to the last, both counted."""
        return (self.time.size - 1) * self.substeps + 1

    def __call__(self, start: int, stop: int) -> Array:
        """Inputs from a step to before another, (steps, 3)."""
        ticks = self._ticks(start, stop)
        wanted = np.interp(ticks, self.time, self.velocity)
        # MuJoCo's position belongs half a step later than its velocity, and an input is held over the step it starts.
        lead = np.interp(ticks, self.time, self.position) + self.timestep / 2.0 * wanted
        return np.stack([lead, wanted, self.feedforward(start, stop)], axis=-1)

    def feedforward(self, start: int, stop: int) -> Array:
        """The effort alone, (steps,)."""
        return np.interp(self._ticks(start, stop) + self.timestep / 2.0 + self.misalignment, self.time, self.effort)

    def _ticks(self, start: int, stop: int) -> Array:
        return self.time[0] + np.arange(start, stop) * self.timestep
