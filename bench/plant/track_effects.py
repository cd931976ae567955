"""Hold an axis with effects softly to a recording: its velocity against the recorded one is the velocity gap.

As `bench.plant.track`, with every effect where it acts: electronics on the recorded effort before the simulation,
mechanisms in MuJoCo (one rollout where all of them are native, else step by step), sensing on what comes out. What
holds the model is the true motion as far as the recording tells it: sensing is undone on the set-points, or the model
would be pulled after the sensor's errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bench.arrays import Array
from bench.effects.mjcf import AXIS, DRIVE
from bench.effects.physics import Electronics, Mechanism
from bench.errors import SimulationError
from bench.plant.axis_model import AxisModel
from bench.plant.native import run_side_by_side
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

#: Position and velocity at every step, (steps,) each; None where it diverged.
Run = tuple[Array, Array] | None


@dataclass(frozen=True)
class Held:
    """A model and the recording that it is to be held to.

    Attributes:
        model: with effects.
        trace: the recording, with velocity or position.
        effort: (n,) torque - N*m (force - N) that the rig makes of it.
        misalignment: by how much the effort is reported late - s.
        inertia: that the cascade is laid out for, the model's if None - kg*m**2 (kg).
    """

    model: AxisModel
    trace: Trace
    effort: Array
    misalignment: float = 0.0
    inertia: float | None = None


@dataclass(frozen=True)
class _Stretch:
    """One stretch without holes of a recording, ready to run: compiled model, its inputs, and where it starts."""

    held: Held
    part: slice
    compiled: mujoco.MjModel
    controls: Array
    substeps: int
    position: float
    velocity: float


def track_effects(
    model: AxisModel, trace: Trace, effort: Array, misalignment: float = 0.0, bandwidth: float = BANDWIDTH
) -> Array:
    """Velocity that an axis with effects reports, held to a recording - rad/s (m/s) - (n,).

    Each stretch without holes is started from the recording; time of effects counts from the recording's start.

    Args:
        model, trace, effort, misalignment: as `Held` has them.
        bandwidth: of the cascade that holds the model - rad/s.

    Raises:
        SimulationError: the model diverged.
    """
    (simulated,) = track_models([Held(model, trace, effort, misalignment)], bandwidth)
    if simulated is None:
        raise SimulationError(DIVERGED)
    return simulated


def track_models(held: Sequence[Held], bandwidth: float = BANDWIDTH) -> list[Array | None]:
    """Velocities that models report, each held to its recording, (n,) each - rad/s (m/s); None where one diverged.

    Models of one structure run side by side, which costs hardly more than one of them where effects are ticked.
    """
    simulated: list[Array | None] = [np.empty(len(one.trace)) for one in held]
    stretches = [(k, stretch) for k, one in enumerate(held) for stretch in _stretches(one, bandwidth)]
    for alike in _alike([stretch for _, stretch in stretches]):
        together = [stretches[i][1] for i in alike]
        runs = _run_ticked(together) if together[0].held.model.ticked else _run_native(together)
        for i, run in zip(alike, runs, strict=True):
            k, stretch = stretches[i]
            target = simulated[k]
            if run is None or target is None:
                simulated[k] = None
                continue
            seen = reported(stretch.held.model, *run, stretch.compiled.opt.timestep)[1]
            target[stretch.part] = seen[:: stretch.substeps]
    return simulated


def _stretches(held: Held, bandwidth: float) -> list[_Stretch]:
    model, trace = held.model, held.trace
    timestep, _ = step_of(trace)
    cascade = holding_cascade(held.inertia or model.parameters.inertia, timestep, bandwidth)
    compiled = holding_model(model.spec(timestep), cascade)
    velocity, found = measured_velocity(trace), []
    for part in trace.segments:
        seen = true_velocity(model, velocity[part], trace.sample_period)
        position = trace["position"][part] if "position" in trace else integrated(seen, trace.sample_period)
        motion = true_motion(model, position, seen)
        controls, substeps = holding_controls(timestep, trace.time[part], *motion, held.effort[part], held.misalignment)
        controls[:, 2] = acting_effort(model, controls[:, 2], timestep)
        found.append(_Stretch(held, part, compiled, controls, substeps, float(motion[0][0]), float(motion[1][0])))
    return found


def _alike(stretches: Sequence[_Stretch]) -> list[list[int]]:
    """Stretches grouped by what is built into their models and how they run: only such can run side by side."""
    groups: dict[tuple[object, ...], list[int]] = {}
    for i, stretch in enumerate(stretches):
        model = stretch.held.model
        key = (model.structure, bool(model.ticked), round(stretch.compiled.opt.timestep, 12))
        groups.setdefault(key, []).append(i)
    return list(groups.values())


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


def _run_native(stretches: Sequence[_Stretch]) -> list[Run]:
    """Position and velocity at every step, (steps,) each, of axes that MuJoCo runs by itself."""
    steps = max(stretch.controls.shape[0] for stretch in stretches)
    found: list[Run] = []
    for states, stretch in zip(
        run_side_by_side(
            [stretch.compiled for stretch in stretches],
            np.stack([_padded(stretch.controls, steps) for stretch in stretches]),
            np.array([[stretch.position, stretch.velocity] for stretch in stretches]),
        ),
        stretches,
        strict=True,
    ):
        count = stretch.controls.shape[0]
        found.append(None if states is None else (states[0][:count], states[1][:count]))
    return found


def _run_ticked(stretches: Sequence[_Stretch]) -> list[Run]:
    """Position and velocity at every step, (steps,) each, of axes whose effects act in every step."""
    models = [stretch.compiled for stretch in stretches]
    batch, half = batch_of(models), models[0].opt.timestep / 2.0
    joint, first = models[0].joint(AXIS), models[0].actuator_ctrladr[models[0].actuator(DRIVE).id]
    position = batch.bind("qpos")[:, joint.qposadr[0]]
    velocity = batch.bind("qvel")[:, joint.dofadr[0]]
    steps = max(stretch.controls.shape[0] for stretch in stretches)
    controls = np.stack([_padded(stretch.controls, steps) for stretch in stretches], axis=1)
    inputs = batch.bind("ctrl")[:, first : first + controls.shape[2]]
    velocity[:] = [stretch.velocity for stretch in stretches]
    position[:] = np.array([stretch.position for stretch in stretches]) + half * velocity
    time = np.array([stretch.held.trace.time[stretch.part][0] - stretch.held.trace.time[0] for stretch in stretches])
    mechanisms = [stretch.held.model.with_effects(stretch.held.model.of_kind(Mechanism)) for stretch in stretches]
    acting = TickedEffects(batch, mechanisms, velocity)
    record = np.empty((steps, 2, len(stretches)))
    with quiet():
        for k, control in enumerate(controls):
            record[k, 0], record[k, 1] = position - half * velocity, velocity
            inputs[:] = control
            inputs[:, 2] = acting.act(time + k * 2.0 * half, position, velocity, control[:, 2])[1]
            batch.step()
    warned = np.asarray(batch.warning).reshape(len(stretches), -1).any(axis=1)
    sound = set(np.flatnonzero(np.isfinite(record).all(axis=(0, 1)) & ~warned).tolist())
    found: list[Run] = []
    for i, stretch in enumerate(stretches):
        rows = record[: stretch.controls.shape[0], :, i]
        found.append((rows[:, 0], rows[:, 1]) if i in sound else None)
    return found


def _padded(controls: Array, steps: int) -> Array:
    """Inputs (n, 3) held to the end of the longest stretch, (steps, 3)."""
    return np.concatenate([controls, np.repeat(controls[-1:], steps - controls.shape[0], axis=0)])
