"""Load-dependent friction: dry friction grows with the magnitude of the transmitted torque (a screw, a worm).

    M = (K_0 + mu*|M_motor|)*sgn(omega)

mu - load friction coefficient, not negative; M_motor - motor torque - N*m (N).
Source: M. Linderoth, A. Stolt, A. Robertsson, R. Johansson, IROS 2013 (load-dependent friction of a gear).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.arrays import Array
from bench.effects.kinds import Axis, Friction, Moment, Number, Values
from bench.effects.signals import Base, Signals
from bench.trace.filter import Column
from bench.units import Quantity

#: Share of the torque that friction takes at most; at one, torque would explain itself whatever it did.
LOSSIEST = 0.7


class LoadDependentFriction(Friction):
    """See the module."""

    name = "load_dependent_friction"
    summary = "friction grows with the magnitude of the transmitted torque"
    quantities = (Quantity("load_friction_coefficient", "mu", "dimensionless", lower=0.0, upper=LOSSIEST, null=0.0),)
    copies_torque = True

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Magnitude of the torque, against the motion."""
        return [[(signals.sign * np.abs(signals.torque), 0)]]

    def level(self, signals: Signals, shape: Sequence[float], strengths: Sequence[float]) -> Array:
        """All of it."""
        return strengths[0] * signals.sign * np.abs(signals.torque)

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """The strength itself."""
        return {"load_friction_coefficient": strengths[0]}

    def friction_excess(self, values: Values, axis: Axis, at: Moment) -> Number:
        """In proportion to the motor's torque."""
        return values["load_friction_coefficient"] * np.abs(at.effort)


EFFECT = LoadDependentFriction()
