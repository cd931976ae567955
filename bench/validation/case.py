"""A case: an axis, what is hidden in it, its motion and its sensors, drawn from seed and index alone."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np

from bench.rig.rig import Rig
from bench.validation.independent.effects import KINDS, Effect
from bench.validation.independent.motions import MOTIONS
from bench.validation.independent.references import Motion
from bench.validation.independent.rig import Axis, random_rig, rig_text
from bench.validation.independent.sensors import Sensors, random_sensors

Plant = Literal["independent", "mujoco"]
PLANTS: tuple[Plant, ...] = ("independent", "mujoco")
#: Of a drawn recording, about - s.
DURATION = (4.0, 8.0)
#: Of every drawn axis' drive, so that axes are integrated side by side - s.
CONTROL_PERIOD = 250e-6
#: Share of drawn axes that are linear, and of drawn motions that are mixed; the others are as many of each kind.
LINEAR, MIXED = 0.12, 0.4
#: How strong a hidden effect is: from just above noise to drastic.
SEVERITY = (0.15, 0.8)


@dataclass(frozen=True)
class Case:
    """What is recorded in one run.

    Attributes:
        index: of the run.
        plant: that moves it.
        axis: true values.
        rig: what is known of the axis.
        motion: that its drive is told to make.
        motion_name: of its kind.
        sensors: that record it.
        effects: hidden in it.
        severity: of these, as drawn.
    """

    index: int
    plant: Plant
    axis: Axis
    rig: Rig
    motion: Motion
    motion_name: str
    sensors: Sensors
    effects: tuple[Effect, ...] = ()
    severity: float = 0.0

    @property
    def hidden(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(effect.name for effect in self.effects)


class Population(Protocol):
    """What cases are drawn from."""

    def plain(self, index: int, rng: np.random.Generator) -> Case:
        """The case of an index, with nothing hidden."""
        ...


@dataclass(frozen=True)
class AnyAxis:
    """Axes, motions and sensors over all their ranges; these stand in `docs/validate.md`."""

    def plain(self, index: int, rng: np.random.Generator) -> Case:
        """As the protocol has it."""
        linear = bool(rng.random() < LINEAR)
        axis = replace(random_rig(rng, f"run {index}", linear=linear), control_period=CONTROL_PERIOD)
        others = (1.0 - MIXED) / (len(MOTIONS) - 1)
        name = str(rng.choice([*MOTIONS], p=[MIXED if k == 0 else others for k in range(len(MOTIONS))]))
        motion = MOTIONS[name](axis, rng, float(rng.uniform(*DURATION)))
        rig = Rig.of(tomllib.loads(rig_text(axis)), axis.name)
        plant = PLANTS[int(rng.integers(len(PLANTS)))]
        return Case(index, plant, axis, rig, motion, name, random_sensors(axis, rng))


def hide(case: Case, names: Sequence[str], rng: np.random.Generator) -> Case:
    """The case with effects of these names, all as strong as one draw says."""
    if not names:
        return case
    severity = float(rng.uniform(*SEVERITY))
    effects = tuple(KINDS[name].draw(case.axis, severity, rng, case.motion.duration) for name in names)
    return replace(case, effects=effects, severity=severity)
