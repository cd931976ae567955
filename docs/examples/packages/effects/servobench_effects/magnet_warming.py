"""Magnets that warm: torque per ampere falls in proportion to time.

    M = r*t*M_motor

r - rate of the loss - 1/s; t - time since the recording's start - s; M_motor - torque by the rig's constant - N*m (N).
"""

from bench.effects.effect import Stage
from bench.effects.torque import Torque
from bench.units import Quantity


class MagnetWarming(Torque):
    """See the module."""

    name = "magnet_warming"
    summary = "torque per ampere falls in proportion to time"
    stage = Stage.TORQUE_CONSTANT
    copies_torque = True
    quantities = (Quantity("rate", "r", "1/s", lower=0.0, null=0.0),)

    def torque(self, values, axis, at):
        """The loss of the motor's torque."""
        return values["rate"] * at.time * at.effort


EFFECT = MagnetWarming()
