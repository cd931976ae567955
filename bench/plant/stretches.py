"""Stretches of recordings, and models ready to be held to them; inputs are made block by block."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bench.arrays import Array
from bench.effects.kinds import Electronics, Sensing
from bench.plant.axis_model import AxisModel
from bench.plant.blocks import blocks, samples_in
from bench.plant.sensing import filtered, filters, misreads_effort, seen, true_effort, true_motion, true_velocity
from bench.plant.track import (
    HoldingInputs,
    holding_cascade,
    holding_model,
    integrated,
    measured_velocity,
    step_of,
    stretches_of,
)
from bench.trace.trace import Trace


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
class Stretch:
    """A model and one stretch without holes of its recording.

    Attributes:
        held: model and recording.
        row: number of `held` among those that are held together.
        part: samples of the stretch.
        compiled: the model for MuJoCo.
        velocity: that is reported, (n,) along the stretch - rad/s (m/s).
        substeps: steps of the model that make a sample period.
    """

    held: Held
    row: int
    part: slice
    compiled: mujoco.MjModel
    velocity: Array
    substeps: int

    @property
    def steps(self) -> int:
        """Steps from its first sample to its last, both counted."""
        return (self.velocity.size - 1) * self.substeps + 1

    @property
    def since(self) -> float:
        """Its start from the start of the recording - s."""
        return float(self.held.trace.time[self.part.start]) - self.held.trace.start_of(self.part)

    @property
    def began(self) -> float:
        """Start of its recording from that of the first, of several that are joined - s."""
        return self.held.trace.start_of(self.part) - float(self.held.trace.time[0])


def all_stretches(held: Sequence[Held], bandwidth: float) -> list[Stretch]:
    """The stretches of recordings, with models that a cascade of a bandwidth - rad/s - holds."""
    velocities = {id(one.trace): measured_velocity(one.trace) for one in held}
    found = []
    for row, one in enumerate(held):
        (timestep, substeps), velocity = step_of(one.trace), velocities[id(one.trace)]
        cascade = holding_cascade(one.inertia or one.model.parameters.inertia, timestep, bandwidth)
        compiled = holding_model(one.model.spec(timestep), cascade)
        found += [Stretch(one, row, part, compiled, velocity[part], substeps) for part in stretches_of(one.trace)]
    return found


@dataclass(frozen=True)
class Inputs:
    """Inputs of a model's drive along a stretch; sensing is undone on what holds it, electronics act on its effort.

    Attributes:
        holding: the inputs but for the electronics.
        model: whose electronics act.
        acting: effort at all steps, faults of its sensor and lags undone - N*m (N) - (steps,); None without any.
    """

    holding: HoldingInputs
    model: AxisModel
    acting: Array | None

    @property
    def start(self) -> tuple[float, float]:
        """Position and velocity - rad (m), rad/s (m/s) - that the model starts with."""
        return float(self.holding.position[0]), float(self.holding.velocity[0])

    def __call__(self, start: int, stop: int) -> Array:
        """Inputs from a step to before another, (steps, 3); after the end of the stretch its last ones are held."""
        last = self.holding.steps - 1
        known = min(start, last), min(stop, last + 1)
        controls = self.holding(*known)
        if self.acting is not None:
            controls[:, 2] = self.acting[slice(*known)]
        for values, effect in _electronics(self.model):
            controls[:, 2] = effect.delivered(values, self.model.axis, controls[:, 2])
        if stop - start == controls.shape[0]:
            return controls
        return controls[np.minimum(np.arange(start, stop), last) - known[0]]


def inputs_of(stretches: Iterable[Stretch]) -> list[Inputs]:
    """Inputs along stretches; what is the same for several of them is made once."""
    motions: dict[tuple[object, ...], tuple[Array, Array]] = {}
    efforts: dict[tuple[object, ...], Array | None] = {}
    found = []
    for stretch in stretches:
        held, part = stretch.held, stretch.part
        key = id(held.trace), part.start, held.model.of_kind(Sensing)
        if key not in motions:
            motions[key] = _motion(stretch)
        holding = HoldingInputs(
            held.trace.time[part],
            *motions[key],
            held.effort[part],
            stretch.compiled.opt.timestep,
            stretch.substeps,
            held.misalignment,
        )
        drive = held.model.of_kind(Electronics), held.model.of_kind(Sensing)
        key = id(held.trace), part.start, id(held.effort), held.misalignment, *drive
        if key not in efforts:
            efforts[key] = _acting(held.model, holding, stretch.since)
        found.append(Inputs(holding, held.model, efforts[key]))
    return found


def _motion(stretch: Stretch) -> tuple[Array, Array]:
    """True position and velocity as far as a recording tells them, (n,) each."""
    model, trace = stretch.held.model, stretch.held.trace
    velocity = true_velocity(model, stretch.velocity, trace.sample_period)
    position = trace["position"][stretch.part] if "position" in trace else integrated(velocity, trace.sample_period)
    return true_motion(model, position, velocity)


def _acting(model: AxisModel, holding: HoldingInputs, since: float) -> Array | None:
    electronics = _electronics(model)
    if not misreads_effort(model) and not any(effect.overrides("acting_along") for _, effect in electronics):
        return None
    effort = np.empty(holding.steps)
    for start, stop in blocks(holding.steps, 8 * 4):
        effort[start:stop] = holding.feedforward(start, stop)
    effort = true_effort(model, effort, since, holding.timestep)
    for values, effect in electronics:
        effort = effect.acting_along(values, effort, holding.timestep)
    return effort


def _electronics(model: AxisModel) -> list[tuple[dict[str, float], Electronics]]:
    present = [(dict(p.values), p.effect) for p in model.of_kind(Electronics)]
    return [(values, effect) for values, effect in present if isinstance(effect, Electronics)]


class Reported:
    """What sensors report of a model at the samples of its stretch, from true motion block by block.

    Args:
        stretch: model and samples.
        into: where it goes, (1, n) or (2, n) along the stretch: velocity - rad/s (m/s) -, then position - rad (m).
    """

    def __init__(self, stretch: Stretch, into: Array) -> None:
        self._model, self._steps, self._substeps = stretch.held.model, stretch.steps, stretch.substeps
        self._timestep, self._into = stretch.compiled.opt.timestep, into
        # a filter needs every step, and nothing else does
        self._every = 1 if filters(self._model) else self._substeps
        self._found = np.empty((len(into), self._steps)) if filters(self._model) else into

    def add(self, start: int, position: Array, velocity: Array) -> None:
        """Position - rad (m) - and velocity - rad/s (m/s) - from a step on, (k,); none beyond the end kept."""
        rows, kept = samples_in(start, min(start + velocity.size, self._steps), self._every)
        reported = seen(self._model, position[rows], velocity[rows])
        self._found[:, kept] = np.stack(reported[::-1][: len(self._found)])

    def finish(self) -> None:
        """Put what is reported where it goes: nothing follows."""
        if self._found is not self._into:
            self._found[0] = filtered(self._model, self._found[0], self._timestep)
            self._into[:] = self._found[:, :: self._substeps]
            self._found = self._into
