"""Saturation of the torque constant: torque per ampere falls at high current, beyond what the rig knows of it.

    M = kT*I*(1 - d*(I/I_peak)**2)

d - drop at peak current; I_peak - peak current - A. Torque rises with current up to the peak,
dM/dI = kT*(1 - 3*d*(I/I_peak)**2) > 0, so d is 1/3 at most.
"""

from collections.abc import Sequence

from bench.effects.acting import TorqueLoss
from bench.effects.effect import Columns
from bench.effects.signals import Axis, Number, Signals, Values
from bench.trace.filter import Column
from bench.units import Quantity


class TorqueConstantSaturation(Columns, TorqueLoss):
    name = "torque_constant_saturation"
    summary = "torque per ampere falls at high current"
    copies_torque = True
    quantities = (Quantity("drop_at_peak", "d", "dimensionless", lower=0.0, upper=1.0 / 3.0, null=0.0),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """M*(M/M_peak)**2: what the rig's constant overstates."""
        return [[(signals.torque * (signals.torque / signals.peak_effort) ** 2, 0)]]

    def delivered(self, values: Values, axis: Axis, effort: Number) -> Number:
        return effort * (1.0 - values["drop_at_peak"] * (effort / axis.peak_effort) ** 2)


EFFECT = TorqueConstantSaturation()
