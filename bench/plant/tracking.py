"""Run a model along a recording: weakly coupled to it, or along its references under the drive of its rig.

`track` couples it: the recorded effort drives the model as feed-forward; measured position and velocity are set-points
of one weak cascade, which keeps the model near the recording where integration alone would drift away. It needs no
references and no drive data. Its bandwidth decides what is seen: a difference in torque of frequency well above it
shows in full, one well below it is held down. State it with every velocity gap.

Every effect is where it acts: electronics on the recorded effort before the simulation, mechanisms in MuJoCo, sensing
on what comes out. The model is coupled to the true motion as far as the recording shows it: sensing is undone on the
set-points, or the model would be pulled after the sensor's errors.

`follow_references` predicts, the model is not coupled. References are read between the samples: velocity by a cubic
that is smooth in acceleration, position by the integral of that, held to the recorded one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bench.arrays import Array
from bench.effects.effect import Stage
from bench.effects.mjcf import pull_load
from bench.effects.signals import AxisState
from bench.errors import InputError, SimulationError
from bench.plant.axis_model import AxisModel
from bench.plant.drive import Cascade, References, add_pid
from bench.plant.plant import DIVERGED, ClosedLoop, PlannedInputs, Plant, States
from bench.plant.run import run, run_loops
from bench.plant.sensing import lags, remaining, reported, reported_states, true_effort, true_motion, true_velocity
from bench.rig.rig import Rig
from bench.trace.motion import integrated, measured_velocity, stretches_of
from bench.trace.trace import Trace

if TYPE_CHECKING:
    import mujoco

#: Bandwidth of the cascade that couples the model - rad/s.
BANDWIDTH = 10.0
#: Bandwidth without an effect: in an hour it moves no model - rad/s.
FREE = 1e-9
#: Longest step of the integration - s.
LONGEST_STEP = 0.5e-3
#: Longest step with a contact, times its damping rate or frequency: explicit steps overshoot from 1 on, diverge from 2.
CONTACT_STEP = 0.5


@dataclass(frozen=True)
class SoftTracking:
    """A model and the recording that it is to be held to.

    Attributes:
        model: with effects.
        trace: the recording, with velocity or position.
        effort: the motor's torque - N*m (force - N) - by the rig, (n,).
        misalignment: by how much the effort is reported late - s.
        inertia: that the cascade is laid out for, the model's if None - kg*m**2 (kg).
        known: torque (force) that is known to resist the motor in addition to the axis, as the rest of a robot does
            (n,).
    """

    model: AxisModel
    trace: Trace
    effort: Array
    misalignment: float = 0.0
    inertia: float | None = None
    known: Array | None = None


@dataclass(frozen=True)
class Tracked:
    """What a held model reports at its recording's samples - rad (m), rad/s (m/s) - (n,); nan outside `stretches_of`.

    Where the recording has no position, that of each stretch counts from zero.
    """

    position: Array
    velocity: Array


def track(held: SoftTracking, bandwidth: float = BANDWIDTH) -> Tracked:
    """Motion that a model reports, held to its recording by a cascade of a bandwidth - rad/s.

    Each stretch without holes starts from the recording; time of effects counts from the recording's start.
    SimulationError where the model diverged, or MuJoCo refuses it, for an inertia too small for one.
    """
    (found,) = track_all([held], bandwidth)
    if found is None:
        raise SimulationError(DIVERGED)
    return found


def track_all(held: Sequence[SoftTracking], bandwidth: float = BANDWIDTH) -> list[Tracked | None]:
    """The same of several models, each held to its recording; None where one diverged."""
    stretches = [(row, *stretch) for row, one in enumerate(held) for stretch in _loops(one, bandwidth)]
    motions = run_loops([loop for _, _, loop, _ in stretches])
    found: list[Tracked | None] = [Tracked(*np.full((2, len(one.trace)), np.nan)) for one in held]
    for (row, part, loop, skip), states in zip(stretches, motions, strict=True):
        tracked = found[row] = None if states.diverged else found[row]
        if tracked is not None:
            tracked.position[part], tracked.velocity[part] = _at_samples(held[row].model, loop, states, skip)
    return found


def run_free(held: SoftTracking, windows: Sequence[slice]) -> list[Tracked]:
    """Motion that a model reports in windows of its recording, each begun as the recording has it and held by nothing.

    SimulationError where the model diverged.
    """
    loops = [*_loops(held, FREE, windows)]
    motions = run_loops([loop for _, loop, _ in loops])
    if any(states.diverged for states in motions):
        raise SimulationError(DIVERGED)
    of_each = zip(loops, motions, strict=True)
    return [Tracked(*_at_samples(held.model, loop, states, skip)) for (_, loop, skip), states in of_each]


def _at_samples(model: AxisModel, loop: ClosedLoop, states: States, skip: int) -> tuple[Array, Array]:
    """Position and velocity that sensors report of a loop's motion, at the recording's samples."""
    step = loop.compiled.opt.timestep
    position, velocity = reported(model, states.position, states.velocity, step)
    return position[::skip], velocity[::skip]


def holding_cascade(inertia: float, timestep: float, bandwidth: float = BANDWIDTH) -> Cascade:
    """Cascade of a bandwidth w - rad/s - for an inertia J - kg*m**2 (kg): K_v = J*w, K_i = J*w**2/6, K_p = w/5.

    With them the loop J*s + K_v + K_i/s has its zero a sixth, its position loop a fifth of the bandwidth below it.
    """
    return Cascade(bandwidth / 5.0, inertia * bandwidth, inertia * bandwidth**2 / 6.0, 0.0, math.inf, timestep)


def _loops(
    held: SoftTracking, bandwidth: float, parts: Sequence[slice] | None = None
) -> Iterator[tuple[slice, ClosedLoop, int]]:
    """Samples of parts of a recording, the loop that couples the model along each, and recorded ticks per sample.

    The parts are all stretches without holes unless others are given.
    """
    model, trace = held.model, held.trace
    longest = _longest_step(model.spec(LONGEST_STEP))
    substeps = math.ceil(trace.sample_period / longest * (1.0 - 1e-9))
    timestep, velocity = trace.sample_period / substeps, measured_velocity(trace)
    spec, mechanics = model.spec(timestep), model.with_effects(model.at_stage((Stage.COMMUTATION, Stage.MECHANICS)))
    add_pid(spec, holding_cascade(held.inertia or model.parameters.inertia, timestep, bandwidth))
    if model.coupled and held.known is not None and held.known.any():
        pull_load(spec)
    try:
        compiled = spec.compile()
    except ValueError as error:
        raise SimulationError(f"MuJoCo refuses the model: {str(error).splitlines()[0]}") from error
    every = 1 if lags(model, "velocity") else substeps  # a lag needs every step, and nothing else does
    for part in stretches_of(trace) if parts is None else parts:
        ticks, start = (part.stop - part.start - 1) * substeps + 1, trace.start_of(part)
        loop = ClosedLoop(
            mechanics,
            compiled,
            *_holding_inputs(held, part, velocity[part], timestep, ticks),
            every=every,
            since=float(trace.time[part.start]) - start,
            began=start - float(trace.time[0]),
        )
        yield part, loop, substeps // every


def _longest_step(spec: mujoco.MjSpec) -> float:
    """Of an integration that keeps up with a model's contacts - s."""
    limits = [joint.solref_limit for joint in spec.joints if joint.solref_limit[0] < 0.0]
    rates = [max(-damping, math.sqrt(-stiffness)) for stiffness, damping in limits]
    return min([LONGEST_STEP, *(CONTACT_STEP / rate for rate in rates)])


def _holding_inputs(
    held: SoftTracking, part: slice, velocity: Array, timestep: float, count: int
) -> tuple[PlannedInputs, Array, float, float]:
    """Position, velocity and effort that the cascade of a held model gets along one stretch, and where that starts.

    Of velocities reported in it - rad/s (m/s) - (n,), at so many ticks, which are timed from zero - s - (ticks,).
    """
    model, trace, time, known = held.model, held.trace, held.trace.time[part], held.known
    velocity = true_velocity(model, velocity, trace.sample_period)
    position = trace["position"][part] if "position" in trace else integrated(velocity, trace.sample_period)
    position, velocity = true_motion(model, position, velocity)

    def recorded(ticks: Array) -> AxisState:
        """Motion and recorded effort, read between samples."""
        effort = np.interp(ticks + timestep / 2.0 + held.misalignment, time, held.effort[part])
        motion = np.interp(ticks, time, position), np.interp(ticks, time, velocity)
        return AxisState(ticks - trace.start_of(part), *motion, effort, step=timestep)

    elapsed = timestep * np.arange(count, dtype=np.float64)
    acting = None  # at all ticks, where faults of its sensor and lags are undone
    if model.at_stage((Stage.CURRENT_SENSOR,)) or lags(model, "torque") or lags(model, "current"):
        acting = true_effort(model, recorded(time[0] + elapsed))
        for lag, values in lags(model, "torque"):
            acting = lag.lagging(values, acting, timestep)

    def between(start: int, stop: int) -> Array:
        """Of the ticks from one to another."""
        ticks = time[0] + elapsed[start:stop]
        at = recorded(ticks)
        # MuJoCo's position belongs half a step later than its velocity, and an input is held over the step it starts
        lead = at.position + timestep / 2.0 * at.velocity
        at = at if acting is None else at._replace(effort=acting[start:stop])
        effort = remaining(model, Stage.TORQUE_CONSTANT, at)
        beside = np.zeros_like(effort) if known is None else np.interp(ticks, time, known[part])
        return np.stack([lead, at.velocity, effort, beside], axis=-1)

    return between, elapsed, float(position[0]), float(velocity[0])


def follow_references(model: AxisModel, trace: Trace, rig: Rig) -> States:
    """What a model reports under the drive of a rig, along the references of a recording that starts at rest.

    At the samples of the recording; the effort of one is that of the tick which begins with it. InputError where there
    are no references, holes, no drive, or samples that are no multiple of its ticks; SimulationError where it diverged.
    """
    cascade = Cascade.from_rig(rig)
    if len(trace.segments) > 1:
        raise InputError(trace.origin, f"found {len(trace.segments) - 1} holes", "allowed: a recording without holes")
    sampled, period = trace.sample_period, cascade.control_period
    stride = round(sampled / period)
    if stride < 1 or abs(stride * period / sampled - 1.0) > 1e-3:
        allowed = f"allowed: a multiple of the control period of {period:g} s"
        raise InputError(trace.origin, f"found samples every {sampled:g} s", allowed)
    plant = Plant(model, cascade, period)
    states = reported_states(plant.model, run(plant, references_of(trace, period, stride)))
    return States(states.time[::stride], *(signal[::stride] for signal in states.signals))


def references_of(trace: Trace, period: float, stride: int) -> References:
    """References of a recording at the drive's ticks - s -, `stride` a sample; InputError where it has none."""
    from scipy.interpolate import CubicSpline  # 0.1 s, which only the drive's own loop has to pay

    ticks: Array = period * np.arange((len(trace) - 1) * stride + 1, dtype=np.float64)
    samples = ticks[::stride]
    if "velocity_reference" in trace:
        velocity = CubicSpline(samples, trace["velocity_reference"])
        integral = velocity.antiderivative()
        position = integral(ticks)
        if "position_reference" in trace:
            position = position + CubicSpline(samples, trace["position_reference"] - integral(samples))(ticks)
        elif "position" in trace:
            position = position + float(trace["position"][0])
        return References(ticks, position, velocity(ticks), velocity(ticks, 1))
    if "position_reference" in trace:
        position = CubicSpline(samples, trace["position_reference"])
        return References(ticks, position(ticks), position(ticks, 1), position(ticks, 2))
    raise InputError(trace.origin, "contains no references", "allowed: velocity_reference or position_reference")
