"""Shapes: quantities of effects that enter nonlinearly, and where a search looks for them first on any axis."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from bench.effects.signals import Scope
from bench.units import Quantity


@dataclass(frozen=True)
class Measure:
    """What a recording has of its own that a quantity goes with: a speed with the top speed, a lag with the filter.

    Attributes:
        of: its value in a recording - SI.
        usual: the value for which grids are stated - the same unit.
        power: of it that the quantity goes with.
        angular: whether the quantity is one of angle, of which a linear axis has none.
    """

    of: Callable[[Scope], float]
    usual: float
    power: int = 1
    angular: bool = False

    def factor(self, scope: Scope) -> float:
        """By which values that are stated for the usual are those of this recording."""
        return (self.of(scope) / self.usual) ** self.power


@dataclass(frozen=True)
class Shape:
    """A quantity of an effect that enters nonlinearly.

    Attributes:
        quantity: name, unit, bounds.
        grid: where a search looks first.
        whole: whether only whole numbers make sense on a rotary axis (a harmonic).
        reach: how far a search goes from there, as factor e**reach, or as distance where `additive`; 0 if it does not.
        additive: whether steps are added rather than multiplied (an instant, an angle).
        step: of a numerical derivative, as share of the value; 0 of what is no free number of the fit.
        measure: that the quantity goes with; None where the grid is valid for every recording.
    """

    quantity: Quantity
    grid: tuple[float, ...] = ()
    whole: bool = False
    reach: float = 0.9
    additive: bool = False
    step: float = 1e-4
    measure: Measure | None = None


#: Shapes of several terms or candidates, or strengths of several terms.
Shapes = Sequence[Sequence[float]]
#: What quantities go with: a speed with the top speed - rad/s -, a lag with the filter's width - s -, a slow change
#: with the duration - s -, a long wave with the inverse of the travel - 1/rad. `usual`: of the axes that grids are of.
SPEED = Measure(lambda scope: scope.top_speed, usual=100.0, angular=True)
ANGLE = Measure(lambda scope: scope.top_speed, usual=100.0, power=-1, angular=True)
LAG = Measure(lambda scope: scope.width, usual=1.5e-3)
FREQUENCY = Measure(lambda scope: scope.width, usual=1.5e-3, power=-1)
DURATION = Measure(lambda scope: scope.duration, usual=8.0)
TRAVEL = Measure(lambda scope: scope.travel, usual=1.0, power=-1, angular=True)
#: Angle of a cycle that the motion must cover - rad: over less, a wave is a mere curve, and a wave of torque copies it.
PERIOD = 2.0 * np.pi
#: Cycles over the travel of a linear axis between which pitches are sought: fewer than two are no repetition.
COARSEST, FINEST = 2.0, 128.0


def grid_of(shapes: Sequence[Shape], scope: Scope) -> list[tuple[float, ...]]:
    """Shapes that a search tries first: all combinations of where each is sought."""
    return list(product(*(places(shape, scope) for shape in shapes)))


def is_pitch(shape: Shape, scope: Scope) -> bool:
    """Whether a harmonic is the wave number of a pitch.

    A linear axis has no revolution that all share: screw, belt and magnets each have a pitch of their own, so a
    harmonic is 2*pi over the pitch there - rad/m -, varies continuously and is sought by the travel.
    """
    return shape.whole and not scope.kind.turns


def places(shape: Shape, scope: Scope) -> tuple[float, ...]:
    """Where a shape is sought first: on its grid, and beyond that by the recording's own measure.

    A motor and the joint behind its gear, a stage and a gantry differ by orders of magnitude. On a linear axis a grid
    of angles is arbitrary, so there only the measure counts.
    """
    if is_pitch(shape, scope):
        return tuple((scope.spacing * np.arange(2.0 * COARSEST, 2.0 * FINEST + 1.0)).tolist())
    if shape.whole:
        return tuple(n for n in shape.grid if n * scope.travel >= PERIOD)
    if shape.measure is None:
        return shape.grid
    factor = shape.measure.factor(scope)
    if shape.measure.angular and not scope.kind.turns:
        return tuple(value * factor for value in shape.grid)
    return extended(shape.grid, factor)


def extended(grid: tuple[float, ...], factor: float) -> tuple[float, ...]:
    """A grid, and where it lies beyond that the same grid times a factor; in order."""
    low, high = min(grid), max(grid)
    return tuple(sorted((*grid, *(value * factor for value in grid if not low <= value * factor <= high))))
