"""Current sensor whose gain differs between the signs of the current.

    M_motor = M_reported + g*|M_reported|

g - half of the difference of the true gain between positive and negative current, over their mean.
"""

from bench.effects.effect import Stage
from bench.effects.torque import Torque
from bench.units import Quantity


class CurrentGainOfSign(Torque):
    """See the module."""

    name = "current_gain_of_sign"
    summary = "amperes per reading differ between positive and negative current"
    stage = Stage.CURRENT_SENSOR
    copies_torque = True
    quantities = (Quantity("gain_difference", "g", "dimensionless", lower=-0.5, upper=0.5, null=0.0),)

    def torque(self, values, axis, at):
        """Error of the reported torque: positive readings are too small, negative ones too large."""
        return -values["gain_difference"] * abs(at.effort)


EFFECT = CurrentGainOfSign()
