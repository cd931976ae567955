"""Axes recorded again and again by the independent integrator: as they were, and with one thing changed."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.rig.rig import Rig, load_rig
from bench.trace.trace import Trace
from bench.validation.independent.effects import KINDS, Effect
from bench.validation.independent.references import Motion, Phase, random_motion
from bench.validation.independent.rig import Axis, random_rig, write_rig
from bench.validation.independent.sensors import Sensors, random_sensors
from bench.validation.independent.simulate import simulate
from tests.cases import residual_ratio

#: Tick of all drives, so that many run side by side, and step of the integration - s.
TICK = 250e-6
#: Of a recording, about - s.
DURATION = 4.0
#: What recordings tell of J, K_w and K_0 is off by, relative: `within`, by which spreads between them are measured.
WITHIN = (1.6e-4, 3.5e-3, 2.8e-3)
#: Severity of a new effect, as the blind set's weak ones have it.
WEAK = (0.15, 0.3)


@dataclass(frozen=True)
class Drawn:
    """An axis and how it is recorded."""

    number: int
    axis: Axis
    motion: Motion
    sensors: Sensors

    @property
    def rng(self) -> np.random.Generator:
        """For what is drawn of it later."""
        return np.random.default_rng([self.number, 17])


@dataclass(frozen=True)
class Again:
    """One more recording: the axis as it is then, its motion and sensors, and a number for its noise."""

    axis: Axis
    motion: Motion
    sensors: Sensors
    effects: tuple[Effect, ...] = ()


@dataclass(frozen=True)
class Recording:
    """A recording, and by how many noises it stands above what J, K_w and K_0 explain."""

    trace: Trace
    ratio: float


def drawn(count: int, seed: int) -> list[Drawn]:
    """Axes with motion and sensors."""
    found = []
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        axis = replace(random_rig(rng, f"axis {number}"), control_period=TICK)
        found.append(Drawn(number, axis, random_motion(axis, rng, DURATION), random_sensors(axis, rng)))
    return found


def as_it_was(one: Drawn, spread: float = 0.0, rng: np.random.Generator | None = None) -> Again:
    """The axis again; `spread`: between recordings, in WITHIN."""
    axis = one.axis
    if spread:
        assert rng is not None
        factors = 1.0 + spread * np.array(WITHIN) * rng.standard_normal(3)
        inertia, viscous, coulomb = np.array([axis.inertia, axis.viscous, axis.coulomb]) * factors
        axis = replace(axis, inertia=float(inertia), viscous=float(viscous), coulomb=float(coulomb))
    return Again(axis, one.motion, one.sensors)


def more_friction(one: Drawn) -> Again:
    """Coulomb friction 10 % higher."""
    return replace(as_it_was(one), axis=replace(one.axis, coulomb=1.1 * one.axis.coulomb))


def heavier(one: Drawn) -> Again:
    """Inertia 2 % higher."""
    return replace(as_it_was(one), axis=replace(one.axis, inertia=1.02 * one.axis.inertia))


def with_effect(one: Drawn, name: str) -> Again:
    """With a weak effect that was not there."""
    effect = KINDS[name].draw(one.axis, float(one.rng.uniform(*WEAK)), one.rng, DURATION)
    return replace(as_it_was(one), effects=(effect,))


def moved_otherwise(one: Drawn) -> Again:
    """Another motion."""
    return replace(as_it_was(one), motion=random_motion(one.axis, one.rng, DURATION))


@dataclass(frozen=True)
class Smaller:
    """A part of a motion, this much smaller, in the same time."""

    phase: Phase
    factor: float

    @property
    def duration(self) -> float:
        """s."""
        return self.phase.duration

    @property
    def distance(self) -> float:
        """rad."""
        return self.factor * self.phase.distance

    def at(self, time: np.ndarray) -> tuple[np.ndarray, ...]:
        """Position, speed, acceleration - rad, rad/s, rad/s**2."""
        return tuple(self.factor * values for values in self.phase.at(time))


def smaller(again: Again, by: float) -> Again:
    """The same with a motion that is smaller by a share: its positions, speeds and accelerations."""
    if not by:
        return again
    return replace(again, motion=Motion(tuple(Smaller(phase, 1.0 - by) for phase in again.motion.phases)))


def sampled_otherwise(one: Drawn) -> Again:
    """Half as many samples."""
    sensors = replace(one.sensors, sample_period=2.0 * one.sensors.sample_period)
    return replace(as_it_was(one), sensors=sensors)


def recorded(wanted: Sequence[Again], seed: int, first: int = 0) -> list[Recording]:
    """Recordings, their noise drawn from seed and place."""
    runs = simulate(
        [one.axis for one in wanted],
        [one.motion for one in wanted],
        [one.effects for one in wanted],
        [one.sensors for one in wanted],
        seed,
        numbers=range(first, first + len(wanted)),
    )
    return [Recording(run.trace, residual_ratio(run) if run.effects else 1.0) for run in runs]


def rigs(axes: Sequence[Drawn]) -> Iterator[Rig]:
    """What a user knows of each axis."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rig.toml"
        for one in axes:
            write_rig(one.axis, path)
            yield load_rig(path)
