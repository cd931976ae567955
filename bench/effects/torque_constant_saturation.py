"""Saturation of the torque constant: torque per ampere falls at high current, beyond what the rig states.

    M = kT*I*(1 - d*(I/I_peak)**2)

d - drop at peak current; I_peak - peak current - A. Torque rises with current up to the peak,
dM/dI = kT*(1 - 3*d*(I/I_peak)**2) > 0, so d is 1/3 at most.
"""

from bench.effects.effect import Stage
from bench.effects.signals import Axis, AxisState, Number, Values
from bench.effects.torque import Torque
from bench.units import Quantity


class TorqueConstantSaturation(Torque):
    name = "torque_constant_saturation"
    summary = "torque per ampere falls at high current"
    stage = Stage.TORQUE_CONSTANT
    copies_torque = True
    quantities = (Quantity("drop_at_peak", "d", "dimensionless", lower=0.0, upper=1.0 / 3.0, null=0.0),)

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """What the rig's constant overstates."""
        return values["drop_at_peak"] * at.effort * (at.effort / axis.peak_effort) ** 2


EFFECT = TorqueConstantSaturation()
