"""Current gain asymmetry: amperes per reading differ between positive and negative current.

    M = M_reported*(1 + d/2*sgn(M_reported))

d - gain of positive less that of negative current, over their mean; M - torque that acts, M_reported = k_T*I of the
reported current - N*m (N). Two amplifiers or two half-bridge shunts, one for each sign, make it; the drive, too,
believes the reading.
Source: D.-W. Chung, S.-K. Sul, Analysis and compensation of current measurement error in vector-controlled AC motor
drives, IEEE Transactions on Industry Applications 34(2), 1998 (scaling errors of current sensors).
"""

from collections.abc import Sequence

import numpy as np

from bench.effects.acting import MisreadEffort
from bench.effects.effect import Columns
from bench.effects.shape import Shapes
from bench.effects.signals import Axis, Number, Scope, Signals, Values
from bench.trace.filter import Column
from bench.units import Quantity

#: Of what two shunts of 5 % make: more, such as what a torque of many waves imitates in one direction, is no sensor's.
MOST = 0.1


class CurrentGainAsymmetry(Columns, MisreadEffort):
    name = "current_gain_asymmetry"
    summary = "amperes per reading differ between positive and negative current"
    copies_torque = True
    quantities = (Quantity("gain_difference", "d", "dimensionless", lower=-1.0, upper=1.0, null=0.0),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """-|M|/2: what the readings of positive current lack, and those of negative have too much."""
        return [[(-0.5 * np.abs(signals.torque), 0)]]

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        return all(abs(difference) <= MOST for (difference,) in strengths)

    def acted(self, values: Values, axis: Axis, effort: Number, time: Number) -> Number:
        return effort + 0.5 * values["gain_difference"] * abs(effort)


EFFECT = CurrentGainAsymmetry()
