"""Run a model beside a recording: held to it softly, or along its references under the drive of its rig.

`track` holds it: the recorded effort drives the model as feed-forward; measured position and velocity are set-points of
one weak cascade, which keeps the model near the recording where integration alone would drift away. It needs no
references and no drive data. Its bandwidth decides what is seen: a difference in torque of frequency well above it
shows in full, one well below it is held down. State it beside every velocity gap.

Every effect is where it acts: electronics on the recorded effort before the simulation, mechanisms in MuJoCo, sensing
on what comes out. What holds the model is the true motion as far as the recording tells it: sensing is undone on the
set-points, or the model would be pulled after the sensor's errors.

`follow_references` predicts, nothing holds the model. References are read between the samples: velocity by a cubic that
is smooth in acceleration, position by the integral of that, held to the recorded one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from bench.arrays import Array
from bench.effects.acting import Mechanism, TorqueLag, TorqueLoss
from bench.errors import InputError, SimulationError
from bench.plant.axis_model import AxisModel
from bench.plant.closed_loop import DIVERGED, ClosedLoop, PlannedInputs
from bench.plant.drive import Cascade, References, add_pid
from bench.plant.measured_motion import integrated, measured_velocity, stretches_of
from bench.plant.plant import Plant
from bench.plant.run import run, run_loops
from bench.plant.sensing import (
    filters,
    misreads_effort,
    reported,
    reported_states,
    true_effort,
    true_motion,
    true_velocity,
)
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Bandwidth of the cascade that holds the model - rad/s.
BANDWIDTH = 10.0
#: Longest step of the integration - s.
LONGEST_STEP = 0.5e-3


@dataclass(frozen=True)
class SoftTracking:
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
class Tracked:
    """What a held model reports at the samples of its recording, (n,) each; nan outside of `stretches_of`.

    Attributes:
        position: rad (m); where the recording holds none, that of each stretch counts from zero.
        velocity: rad/s (m/s).
    """

    position: Array
    velocity: Array


def track(held: SoftTracking, bandwidth: float = BANDWIDTH) -> Tracked:
    """Motion that a model reports, held to its recording.

    Each stretch without holes starts from the recording; time of effects counts from the recording's start.

    Args:
        held: the model and its recording.
        bandwidth: of the cascade that holds the model - rad/s.

    Raises:
        SimulationError: the model diverged, or MuJoCo refuses it, for an inertia too small for one.
    """
    (found,) = track_all([held], bandwidth)
    if found is None:
        raise SimulationError(DIVERGED)
    return found


def track_all(held: Sequence[SoftTracking], bandwidth: float = BANDWIDTH) -> list[Tracked | None]:
    """The same of several models, each held to its recording; None where one diverged.

    Raises:
        SimulationError: MuJoCo refuses a model, for an inertia too small for one.
    """
    stretches = [(row, stretch) for row, one in enumerate(held) for stretch in _stretches(one, bandwidth)]
    motions = run_loops([stretch.loop for _, stretch in stretches])
    found = [Tracked(*np.full((2, len(one.trace)), np.nan)) for one in held]
    diverged = set()
    for (row, stretch), states in zip(stretches, motions, strict=True):
        if states.diverged:
            diverged.add(row)
            continue
        step, skip = stretch.loop.compiled.opt.timestep, stretch.substeps // stretch.loop.every
        position, velocity = reported(held[row].model, states.position[:, 0], states.velocity[:, 0], step)
        found[row].position[stretch.part], found[row].velocity[stretch.part] = position[::skip], velocity[::skip]
    return [None if row in diverged else each for row, each in enumerate(found)]


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


@dataclass(frozen=True)
class _Stretch:
    """One stretch without holes of a recording: its samples, the loop along it, and steps per sample."""

    part: slice
    loop: ClosedLoop
    substeps: int


def _stretches(held: SoftTracking, bandwidth: float) -> Iterator[_Stretch]:
    """The stretches of a recording, each with its model in the loop that holds it."""
    model, trace = held.model, held.trace
    (timestep, substeps), velocity = step_of(trace), measured_velocity(trace)
    cascade = holding_cascade(held.inertia or model.parameters.inertia, timestep, bandwidth)
    compiled, mechanics = _compiled(model, cascade), model.with_effects(model.of_kind(Mechanism))
    for part in stretches_of(trace):
        inputs = _HoldingInputs(held, part, velocity[part], timestep, substeps)
        start = trace.start_of(part)
        loop = ClosedLoop(
            mechanics,
            compiled,
            inputs,
            timestep * np.arange(inputs.ticks, dtype=np.float64),
            *inputs.start,
            every=1 if filters(model) else substeps,  # a filter needs every step, and nothing else does
            since=float(trace.time[part.start]) - start,
            began=start - float(trace.time[0]),
        )
        yield _Stretch(part, loop, substeps)


def _compiled(model: AxisModel, cascade: Cascade) -> mujoco.MjModel:
    """The model with the cascade, effort being its feed-forward; SimulationError where MuJoCo refuses it."""
    spec = model.spec(cascade.control_period)
    add_pid(spec, cascade)
    try:
        return spec.compile()
    except ValueError as error:
        raise SimulationError(f"MuJoCo refuses the model: {str(error).splitlines()[0]}") from error


class _HoldingInputs(PlannedInputs):
    """Position, velocity and effort that the cascade of a held model gets along one stretch.

    Args:
        held: the model and its recording.
        part: samples of the stretch.
        velocity: reported in it - rad/s (m/s) - (n,).
        timestep: of the model - s.
        substeps: timesteps that make a sample period.
    """

    def __init__(self, held: SoftTracking, part: slice, velocity: Array, timestep: float, substeps: int) -> None:
        model, trace = held.model, held.trace
        velocity = true_velocity(model, velocity, trace.sample_period)
        position = trace["position"][part] if "position" in trace else integrated(velocity, trace.sample_period)
        self._position, self._velocity = true_motion(model, position, velocity)
        self._time, self._effort, self._held = trace.time[part], held.effort[part], held
        self._since, self._timestep = float(trace.time[part.start]) - trace.start_of(part), timestep
        self._losses = model.acting(TorqueLoss)
        self.ticks = (velocity.size - 1) * substeps + 1

    @property
    def start(self) -> tuple[float, float]:
        """Position and velocity - rad (m), rad/s (m/s) - that the model starts with."""
        return float(self._position[0]), float(self._velocity[0])

    def between(self, start: int, stop: int) -> Array:
        """See `PlannedInputs`: read between samples."""
        ticks = self._ticks(start, stop)
        wanted = np.interp(ticks, self._time, self._velocity)
        # MuJoCo's position belongs half a step later than its velocity, and an input is held over the step it starts
        lead = np.interp(ticks, self._time, self._position) + self._timestep / 2.0 * wanted
        effort = self._recorded(start, stop) if self._acting is None else self._acting[start:stop]
        for effect, values in self._losses:
            effort = effect.delivered(values, self._held.model.axis, effort)
        return np.stack([lead, wanted, effort], axis=-1)

    def _ticks(self, start: int, stop: int) -> Array:
        return self._time[0] + np.arange(start, stop) * self._timestep

    def _recorded(self, start: int, stop: int) -> Array:
        """Effort as it is recorded - N*m (N) - (ticks,)."""
        at = self._ticks(start, stop) + self._timestep / 2.0 + self._held.misalignment
        return np.interp(at, self._time, self._effort)

    @cached_property
    def _acting(self) -> Array | None:
        """Effort at all ticks, faults of its sensor and lags undone - N*m (N); None without any."""
        model = self._held.model
        lags = model.acting(TorqueLag)
        if not misreads_effort(model) and not lags:
            return None
        effort = true_effort(model, self._recorded(0, self.ticks), self._since, self._timestep)
        for effect, values in lags:
            effort = effect.acting_along(values, effort, self._timestep)
        return effort


@dataclass(frozen=True)
class Followed:
    """What a model under its drive reports at the samples of a recording, (n,) each.

    Attributes:
        position: rad (m).
        velocity: rad/s (m/s).
        effort: reported torque, of the tick that begins with the sample - N*m (N).
    """

    position: Array
    velocity: Array
    effort: Array


def follow_references(model: AxisModel, trace: Trace, rig: Rig) -> Followed:
    """Run a model along the references of a recording without holes.

    Args:
        model: with effects.
        trace: with `velocity_reference` or `position_reference`, at rest at its start.
        rig: with `[drive]`.

    Raises:
        InputError: no references, holes, a rig without drive, or samples that are no multiple of its ticks.
        SimulationError: the simulation diverged.
    """
    cascade = Cascade.from_rig(rig)
    if len(trace.segments) > 1:
        raise InputError(trace.origin, f"found {len(trace.segments) - 1} holes", "allowed: a recording without holes")
    stride = round(trace.sample_period / cascade.control_period)
    if stride < 1 or abs(stride * cascade.control_period / trace.sample_period - 1.0) > 1e-3:
        raise InputError(
            trace.origin,
            f"found samples every {trace.sample_period:g} s",
            f"allowed: a multiple of the control period of {cascade.control_period:g} s",
        )
    plant = Plant.of(model, cascade)
    states = reported_states(plant.model, run([plant], [references_of(trace, cascade.control_period, stride)]))
    rows = slice(None, None, stride)
    return Followed(states.position[rows, 0], states.velocity[rows, 0], states.torque[rows, 0])


def references_of(trace: Trace, period: float, stride: int) -> References:
    """References of a recording at the drive's ticks, `stride` of which make a sample.

    Raises:
        InputError: the recording holds none.
    """
    from scipy.interpolate import CubicSpline  # 0.1 s, which only the drive's own loop has to pay

    ticks: Array = period * np.arange((len(trace) - 1) * stride + 1, dtype=np.float64)
    samples = ticks[::stride]
    if "velocity_reference" in trace:
        velocity = CubicSpline(samples, trace["velocity_reference"])
        position = velocity.antiderivative()
        offset = float(trace["position"][0]) if "position" in trace else 0.0
        if "position_reference" in trace:
            recorded = trace["position_reference"]
            slow = CubicSpline(samples, recorded - position(samples))(ticks)
            return References(ticks, position(ticks) + slow, velocity(ticks), velocity(ticks, 1))
        return References(ticks, position(ticks) + offset, velocity(ticks), velocity(ticks, 1))
    if "position_reference" in trace:
        position = CubicSpline(samples, trace["position_reference"])
        return References(ticks, position(ticks), position(ticks, 1), position(ticks, 2))
    raise InputError(trace.origin, "holds no references", "allowed: velocity_reference or position_reference")
