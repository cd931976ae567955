"""A hypothesis: which effects there are and of what shape."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CURRENT_LAG, VELOCITY_LAG = "current_loop_lag", "velocity_filter_lag"
BACKLASH, SPRING = "backlash", "torsion_spring"
ELASTIC, ECCENTRICITY, DIRECTION = "elastic_coupling", "encoder_eccentricity", "direction_dependent_friction"
#: Effects that change how columns are made instead of adding columns of raw products.
TRANSFORMS = (CURRENT_LAG, VELOCITY_LAG, ECCENTRICITY, ELASTIC, BACKLASH)


@dataclass(frozen=True)
class Named:
    """An effect with its shape quantities, in the order in which the effect lists them."""

    name: str
    shape: tuple[float, ...] = ()


@dataclass(frozen=True)
class Hypothesis:
    """Effects beyond inertia, viscous and Coulomb friction.

    Attributes:
        effects: in the order they were added.
        levels: strengths over K_0 of each effect that is dry friction, () of the others.
        mains: frequencies of the hum in this recording's sensors - Hz.
        loads: strengths over load inertia of each effect that may act on the load, () of the others, where a soft
            coupling lets the recording tell that they do; None where they act on the motor.
    """

    effects: tuple[Named, ...] = ()
    levels: tuple[tuple[float, ...], ...] = ()
    mains: tuple[float, ...] = ()
    loads: tuple[tuple[float, ...], ...] | None = None

    def with_effect(self, named: Named) -> Hypothesis:
        """This hypothesis and one effect more."""
        return replace(self, effects=(*self.effects, named))

    def with_mains(self, mains: tuple[float, ...]) -> Hypothesis:
        """This hypothesis with hum at frequencies - Hz."""
        return replace(self, mains=mains)

    def without(self, index: int) -> Hypothesis:
        """This hypothesis less one of its effects."""
        effects, levels, loads = self.effects, self.levels, self.loads
        return replace(
            self,
            effects=(*effects[:index], *effects[index + 1 :]),
            levels=(*levels[:index], *levels[index + 1 :]),
            loads=None if loads is None else (*loads[:index], *loads[index + 1 :]),
        )

    def reshaped(self, index: int, shape: tuple[float, ...]) -> Hypothesis:
        """This hypothesis with another shape of one effect."""
        effect = replace(self.effects[index], shape=shape)
        return replace(self, effects=(*self.effects[:index], effect, *self.effects[index + 1 :]))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(effect.name for effect in self.effects)

    def shape_of(self, name: str) -> tuple[float, ...] | None:
        """Shape of an effect, None where it is not in."""
        return next((effect.shape for effect in self.effects if effect.name == name), None)
