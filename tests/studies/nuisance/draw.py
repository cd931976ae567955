"""Which cases there are: each nuisance at each strength, on an axis with nothing hidden and on some with one effect.

A case depends on seed, nuisance, strength and place alone: others may come or go, it stays.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from zlib import crc32

import numpy as np

from bench.validation.independent.effects import CATALOGUE, Effect
from bench.validation.independent.references import Motion
from bench.validation.independent.rig import Axis, random_rig
from tests.studies.nuisance.kinds import NUISANCES
from tests.studies.nuisance.nuisance import Nuisance, Strength, label
from tests.studies.nuisance.signals import FINE

#: Of what is hidden: well above the noise of a sound recording.
SEVERITY = (0.4, 0.8)


@dataclass(frozen=True)
class Case:
    """A recording to be damaged.

    Attributes:
        nuisance, level, place: name of the nuisance, place of its strength, and which of its cases.
        axis, effect, motion: nature; effect None where nothing is hidden.
        references: whether the recording holds the drive's references.
        seed: of noise and damage.
    """

    nuisance: str
    level: int
    place: int
    axis: Axis
    effect: Effect | None
    motion: Motion
    references: bool
    seed: tuple[int, ...]

    @property
    def kind(self) -> Nuisance:
        """What damages it."""
        return NUISANCES[self.nuisance]

    @property
    def strength(self) -> Strength:
        """Of the damage."""
        return self.kind.strengths[self.level]

    @property
    def strength_label(self) -> str:
        """The same for a table."""
        return label(self.kind, self.strength)

    @cached_property
    def name(self) -> str:
        """As `jitter-1-0`: nuisance, place of the strength, place of the case."""
        return f"{self.nuisance}-{self.level}-{self.place}"

    @property
    def effects(self) -> tuple[Effect, ...]:
        """What is hidden."""
        return () if self.effect is None else (self.effect,)

    @property
    def hidden(self) -> str:
        """Its name, empty where nothing is."""
        return "" if self.effect is None else self.effect.name


def draw(seed: int, each: int) -> list[Case]:
    """Cases of every nuisance at every strength: the first with nothing hidden, each further one with an effect."""
    return [
        one(seed, name, level, place)
        for name, nuisance in NUISANCES.items()
        for level in range(len(nuisance.strengths))
        for place in range(each)
    ]


def one(seed: int, name: str, level: int, place: int) -> Case:
    """The case of a nuisance at a place."""
    key = (seed, crc32(name.encode()), level, place)
    rng, nuisance = np.random.default_rng(key), NUISANCES[name]
    axis = replace(random_rig(rng), control_period=FINE)
    motion = nuisance.motion(axis, nuisance.strengths[level], rng)
    references = bool(rng.random() < 0.5)
    kind = None
    if place > 0:
        suited = [kind for name, kind in CATALOGUE.items() if name not in nuisance.unsuited]
        # in turn, so that a few cases hold many effects
        kind = suited[(key[1] + 7 * level + 5 * place + 3 * seed) % len(suited)]
    effect = None if kind is None else kind.draw(axis, float(rng.uniform(*SEVERITY)), rng, motion.duration)
    return Case(name, level, place, axis, effect, motion, references, (*key, 1))
