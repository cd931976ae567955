"""Torques without memory: the function that a simulation steps is the one that makes the columns of the balance.

    column_k = torque(strengths 1 to k are one) - torque(strengths 1 to k - 1 are one)

Values at unit strengths are those that the effect reports for an axis of J = K_w = K_0 = 1. Formulas take numbers and
arrays of any library of the array API standard, so that they serve a recording as well as axes side by side.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bench.arrays import Array
from bench.effects.effect import Columns
from bench.effects.signals import Axis, AxisState, Number, Scope, Signals, Values
from bench.trace.filter import Column

#: Terms of a column at the samples, each with the order of its derivative.
Terms = list[tuple[Number, int]]


class Torque(Columns):
    """A torque of the present state, linear in its strengths."""

    memoryless = True

    @abstractmethod
    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """Torque against the motor's, or what the torque that reaches its stage loses there - N*m (N)."""

    def resisting(self, signals: Signals, strengths: Sequence[float], shape: Sequence[float]) -> Terms:
        """Its terms at the samples for such strengths, as a column has them."""
        axis = signals.unit
        return [(self.torque(self.report(strengths, shape, axis), axis, signals.state), 0)]

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Resisting torque per unit of each strength - N*m (N) per unit - (n,), unfiltered."""
        count = len({each.name for each in self.quantities} - {slot.quantity.name for slot in self.shapes})
        units = [[1.0] * k + [0.0] * (count - k) for k in range(count + 1)]
        made = [self.resisting(signals, strengths, shape) for strengths in units]
        size = signals.time.shape
        return [
            [
                (np.broadcast_to(more - less, size), order)
                for (more, order), (less, _) in zip(after, before, strict=True)
            ]
            for before, after in pairwise(made)
        ]


class Friction(Torque):
    """Dry friction of the present state, in addition to Coulomb friction; its `torque` is what else resists."""

    @abstractmethod
    def friction(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """Dry friction in the direction `at.direction`, in addition to `at.friction` - N*m (N)."""

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """Nothing but dry friction, by default."""
        return 0.0

    def sought(self, scope: Scope) -> bool:
        """Not in motion of one direction, where such friction looks like a torque, e.g. like an unbalance."""
        return super().sought(scope) and not scope.one_way

    def resisting(self, signals: Signals, strengths: Sequence[float], shape: Sequence[float]) -> Terms:
        """Dry friction with its sign, and what else resists."""
        (other,) = super().resisting(signals, strengths, shape)
        return [(self.signed(signals, strengths, shape) + other[0], 0)]

    def signed(self, signals: Signals, strengths: Sequence[float], shape: Sequence[float]) -> Array:
        """Dry friction at the samples (n,) with its sign, in addition to Coulomb's - the strengths' unit."""
        axis, at = signals.unit, signals.state
        values = self.report(strengths, shape, axis)
        forward = self.friction(values, axis, at)
        if self.scales_friction:  # in proportion to a level that has its sign
            return forward
        if not self.directed:
            return signals.sign * forward
        backward = self.friction(values, axis, at.of_direction(-1.0))
        return 0.5 * (forward - backward) + 0.5 * (forward + backward) * signals.sign

    def law(self, values: Mapping[str, float], axis: Axis) -> FrictionLaw | None:
        """The same in the words of other simulators; None where they have none."""
        return None


@dataclass(frozen=True)
class FrictionLaw:
    """Dry friction in the words that other simulators have, which is added to Coulomb friction.

        K = rise*exp(-(|omega|/velocity)**exponent) + |motor*M_motor - external*M_external|

    Source: M. Duclusaud et al., Extended Friction Models for the Physics Simulation of Servo Actuators, 2024 (M2, M5).

    Attributes:
        rise: towards standstill - N*m (N).
        velocity: at which it has fallen to 1/e - rad/s (m/s).
        exponent: dimensionless.
        motor, external: shares of the motor's torque, and of what acts on the joint from outside - dimensionless.
    """

    rise: float = 0.0
    velocity: float = math.inf
    exponent: float = 2.0
    motor: float = 0.0
    external: float = 0.0


class Inertia(Torque):
    """Inertia that varies with position, and the torque that its change of kinetic energy costs.

        M = d/dt(J(q)*omega) - J'(q)*omega**2/2 = J(q)*alpha + J'(q)*omega**2/2

    Lagrange's equation of J(q)*omega**2/2. In the columns only raw products are differentiated.
    """

    @abstractmethod
    def inertia(self, values: Values, axis: Axis, position: Number) -> tuple[Number, Number]:
        """Inertia in addition to the axis' - kg*m**2 (kg) -, and its slope over position - kg*m**2/rad (kg/m)."""

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """What a changing inertia takes in addition to that of accelerating it."""
        return 0.5 * self.inertia(values, axis, at.position)[1] * at.velocity**2

    def resisting(self, signals: Signals, strengths: Sequence[float], shape: Sequence[float]) -> Terms:
        """Change of its momentum, less that of its kinetic energy over position."""
        values = self.report(strengths, shape, signals.unit)
        inertia, slope = self.inertia(values, signals.unit, signals.position)
        return [(inertia * signals.velocity, 1), (-0.5 * slope * signals.velocity**2, 0)]
