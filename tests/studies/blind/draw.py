"""Which cases there are: every effect at every strength in turn, pairs, nothing, and physics outside the catalogue.

A case depends on seed, group and number alone, so that one can be drawn again without the others.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.validation.independent.effects import CATALOGUE, any_effects
from tests.cases import Hidden, hidden
from tests.outside import OUTSIDE

#: Severity of an effect by strength; 1 is drastic.
STRENGTHS = {"weak": (0.15, 0.3), "middle": (0.3, 0.5), "strong": (0.5, 0.8)}
#: Severity of each effect of a pair, and of what is outside the catalogue.
TOGETHER = (0.3, 0.8)
#: Groups, in the order of their numbers.
GROUPS = ("single", "pair", "null", "outside", "crowd")
#: Effects of a crowd.
CROWD = (3, 6)
#: Cases of a group at most, so that no two share a number.
MOST = 100_000
#: Share of axes that are linear.
LINEAR = 0.12


@dataclass(frozen=True)
class Drawn:
    """A case and the number from which its motion and noise are drawn."""

    hidden: Hidden
    number: int

    @property
    def name(self) -> str:
        """Group and place in it, as `single-057`."""
        return self.hidden.name


def draw(seed: int, counts: dict[str, int], duration: float, control_period: float | None = None) -> list[Drawn]:
    """Cases of each group.

    Args:
        seed: of everything random.
        counts: cases by group.
        duration: of the first recording, about - s.
        control_period: of every axis; random if None - s.
    """
    return [
        one(seed, group, place, duration, control_period) for group in GROUPS for place in range(counts.get(group, 0))
    ]


def one(seed: int, group: str, place: int, duration: float, control_period: float | None = None) -> Drawn:
    """The case of a group at a place."""
    code = GROUPS.index(group)
    rng = np.random.default_rng([seed, code, place])
    linear = bool(rng.random() < LINEAR)
    effects, severity = _effects(group, place, rng, linear)
    linear = linear and all({**CATALOGUE, **OUTSIDE}[effect].on_linear_axis for effect in effects)
    case = hidden(f"{group}-{place:03d}", effects, severity, rng, duration=duration, linear=linear)
    if control_period is not None:
        case = replace(case, axis=replace(case.axis, control_period=control_period))
    return Drawn(case, code * MOST + place)


def _effects(
    group: str, place: int, rng: np.random.Generator, linear: bool
) -> tuple[tuple[str, ...], tuple[float, float]]:
    if group == "single":
        strength = list(STRENGTHS.values())[place // len(CATALOGUE) % len(STRENGTHS)]
        return (list(CATALOGUE)[place % len(CATALOGUE)],), strength
    if group == "pair":
        return any_effects(2, rng, linear=linear), TOGETHER
    if group == "crowd":
        return any_effects(int(rng.integers(CROWD[0], CROWD[1] + 1)), rng, linear=linear), TOGETHER
    if group == "outside":
        return (list(OUTSIDE)[place % len(OUTSIDE)],), TOGETHER
    return (), TOGETHER


def strength_of(severity: float) -> str:
    """Name of a single's strength."""
    return next(name for name, (_, top) in STRENGTHS.items() if severity <= top or name == "strong")


def noise_of(case: Hidden) -> str:
    """What kind of noise speed and current carry, as `white/hum`."""
    return f"{case.sensors.velocity.kind}/{case.sensors.current.kind}"
