"""What an effect is: quantities with units and bounds, and the columns by which it enters the torque balance.

    motor torque = J*alpha + K_w*omega + K_0*sgn(omega) + sum over effects of strength_k * column_k(signals, shape)

Strengths enter linearly; shapes (a Stribeck speed, a harmonic, a time constant) do not and are profiled.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.units import Quantity

#: Raw samples (n,) and the order of the time derivative to be taken of them by the filter; a column is a sum of terms.
#: So products are formed on raw samples and differentiated exactly: q''*sin(q) = (q'*sin(q))' - q'**2*cos(q).
Term = tuple[Array, int]
Column = Sequence[Term]


@dataclass(frozen=True)
class Signals:
    """Raw samples of one stretch of a recording, all (n,).

    Attributes:
        time: since the recording's start - s.
        position: rad (m); from speed by the trapezoidal rule where it is not recorded.
        velocity: rad/s (m/s).
        sign: sgn(omega), 0 where noise may have made it.
        effort: motor torque as reported - N*m (N).
        torque: motor torque as it acts, which a lag of the current loop delays - N*m (N).
        friction: level of dry friction with its sign, as share of K_0: sgn(omega), or what a named effect makes of it;
            effects that scale dry friction multiply it.
        peak_effort: effort at the motor's peak current - N*m (N); the recording's largest where the rig tells none.
        sample_period: s.
    """

    time: Array
    position: Array
    velocity: Array
    sign: Array
    effort: Array
    torque: Array
    friction: Array
    peak_effort: float
    sample_period: float


@dataclass(frozen=True)
class Base:
    """What the torque balance without effects has: J - kg*m**2 (kg), K_w - N*m*s/rad (N*s/m), K_0 - N*m (N)."""

    inertia: float
    viscous: float
    coulomb: float


@dataclass(frozen=True)
class Shape:
    """A quantity that enters nonlinearly.

    Attributes:
        quantity: name, unit, bounds.
        grid: where a search looks first.
        whole: whether only whole numbers make sense (a harmonic).
    """

    quantity: Quantity
    grid: tuple[float, ...]
    whole: bool = False


class Effect(ABC):
    """One piece of physics that adds columns to the torque balance.

    Attributes:
        name: as in the contract.
        summary: one line.
        quantities: what is reported of it, with unit and bounds.
        shapes: the nonlinear ones, in the order in which `columns` takes them.
        searched: whether a search may try its columns over the grids of its shapes.
        scales_friction: whether it multiplies the level of dry friction, what other effects add to it included.
        may_load: whether it may act on the load of a coupling rather than on the motor.
        of_speed_alone: whether its torque follows from speed alone, so that a map of friction over speed may hold it.
    """

    name: str
    summary: str
    quantities: tuple[Quantity, ...]
    shapes: tuple[Shape, ...] = ()
    searched: bool = True
    scales_friction: bool = False
    may_load: bool = False
    of_speed_alone: bool = False

    @abstractmethod
    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Resisting torque per unit of each strength - N*m (N) per unit, raw samples before the filter."""

    @abstractmethod
    def values(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """The effect's quantities from fitted strengths and shape - SI."""

    def level(self, signals: Signals, shape: Sequence[float], strengths: Sequence[float]) -> Array | float:
        """Dry friction beside Coulomb's, with its sign, that strengths make - the strengths' unit - (n,)."""
        return 0.0

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> bool:
        """Whether physics allows these values: every quantity within its bounds."""
        found = self.values(strengths, shape, base)
        return all(q.lower <= found[q.name] <= q.upper for q in self.quantities if q.name in found)


def amplitude_and_phase(sine: float, cosine: float) -> tuple[float, float]:
    """A, phi of A*sin(x + phi) = sine*sin(x) + cosine*cos(x); phi - rad in (-pi, pi]."""
    return float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))
