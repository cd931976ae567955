"""Draw hidden cases at random: which effects, how strong, on which axis, recorded how."""

from __future__ import annotations

import numpy as np

from bench.validation.independent.case import Hidden
from bench.validation.independent.effects import CATALOGUE, KINDS, OUTSIDE
from bench.validation.independent.rig import random_rig
from bench.validation.independent.sensors import random_sensors

GROUPS = {0: "null", 1: "single", 2: "pair", 3: "triple"}


def hidden(
    name: str,
    effects: tuple[str, ...],
    severity: tuple[float, float],
    rng: np.random.Generator,
    *,
    duration: float = 8.0,
    noise: float = 1.0,
    linear: bool = False,
) -> Hidden:
    """A case that hides the named effects, with a severity drawn from a range; everything else at random."""
    axis = random_rig(rng, name, linear=linear)
    strength = float(rng.uniform(*severity)) if effects else 0.02
    sensors = random_sensors(axis, rng, noise)
    drawn = tuple(KINDS[effect].draw(axis, strength, rng, duration) for effect in effects)
    outside = any(effect in OUTSIDE for effect in effects)
    return Hidden(name, axis, drawn, sensors, "outside" if outside else GROUPS[len(effects)], strength, duration)


def any_effects(
    count: int, rng: np.random.Generator, *, linear: bool = False, without: frozenset[str] = frozenset()
) -> tuple[str, ...]:
    """Names of `count` effects of the catalogue that can be hidden together, on a linear axis or without some."""
    allowed = [name for name, kind in CATALOGUE.items() if (kind.on_linear_axis or not linear) and name not in without]
    while True:
        names = tuple(str(name) for name in rng.choice(allowed, count, replace=False))
        if not any(KINDS[name].never_beside in names for name in names):
            return names
