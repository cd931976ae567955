"""What is to be run: an axis, what is hidden in it, its motion and its sensors, drawn from seed and index alone."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.names import nearest
from bench.rig.rig import Rig
from bench.validation.independent.effects import KINDS, Effect, any_effects
from bench.validation.independent.references import MOTIONS, Motion
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
        axis, rig: its true values, and what is known of it.
        motion, motion_name: that its drive is told to make, and its kind.
        sensors: that record it.
        effects, severity: hidden in it, as strong as was drawn.
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


#: What cases are drawn from: the case of an index, with nothing hidden, by a generator of its own.
Population = Callable[[int, np.random.Generator], Case]


def any_axis(index: int, rng: np.random.Generator) -> Case:
    """Axis, motion and sensors over all their ranges; these stand in `docs/validate.md`."""
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


#: Names that can be hidden: those that the independent axis has too.
HIDEABLE = tuple(name for name in KINDS if name in catalogue())
#: Effects at most in one axis.
MOST = 6
COUNTS = re.compile(r"(\d+)(?:-(\d+))?")


@dataclass(frozen=True)
class Hiding:
    """What is hidden.

    Attributes:
        least, most: how many of the catalogue, drawn at random.
        names: instead, each alone in turn, and after the last of them a run with nothing hidden.
    """

    least: int = 0
    most: int = 0
    names: tuple[str, ...] = ()

    @classmethod
    def parse(cls, text: str) -> Hiding:
        """`2`, `0-3`, `all`, or names separated by commas.

        Raises:
            InputError: none of these.
        """
        counts = COUNTS.fullmatch(text.strip())
        if counts:
            least = int(counts[1])
            most = int(counts[2] or least)
            if not least <= most <= MOST:
                raise InputError("--effects", f"found {text}", f"allowed: 0 to {MOST}, the smaller number first")
            return cls(least, most)
        names = HIDEABLE if text.strip() == "all" else tuple(name.strip() for name in text.split(","))
        for name in names:
            if name not in HIDEABLE:
                found = f"found '{name}'{nearest(name, list(HIDEABLE))}"
                raise InputError("--effects", found, f"allowed: a count as 0-3, all, or some of {', '.join(HIDEABLE)}")
        return cls(names=names)

    @property
    def anything(self) -> bool:
        """Whether any run hides an effect."""
        return self.most > 0 or bool(self.names)

    def drawn(self, index: int, rng: np.random.Generator, axis: Axis) -> tuple[str, ...]:
        """Names hidden in a run, of those that its axis can have."""
        impossible = frozenset(name for name in HIDEABLE if not KINDS[name].possible(axis))
        if self.names:
            place = index % (len(self.names) + 1)
            return tuple(name for name in self.names[place : place + 1] if name not in impossible)
        return any_effects(int(rng.integers(self.least, self.most + 1)), rng, without=impossible)


@dataclass(frozen=True)
class Plan:
    """A Monte Carlo; run k depends on the seed, k and what is drawn from, and on nothing else.

    Attributes:
        seed: of all that is random.
        hiding: effects of the runs.
        diagnose: whether `diagnose` is asked too, and not `identify` alone.
        population: that cases are drawn from.
    """

    seed: int = 0
    hiding: Hiding = Hiding()
    diagnose: bool = False
    population: Population = any_axis

    def case(self, index: int) -> Case:
        """The case of an index."""
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(index,)))
        plain = self.population(index, rng)
        return hide(plain, self.hiding.drawn(index, rng, plain.axis), rng)
