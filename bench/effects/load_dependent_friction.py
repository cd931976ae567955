"""Load-dependent friction: dry friction grows with the magnitude of the transmitted torque (a screw, a worm).

    M = (K_0 + mu*|M_motor|)*sgn(omega)

mu - load friction coefficient, not negative; M_motor - motor torque - N*m (N).
Source: M. Linderoth, A. Stolt, A. Robertsson, R. Johansson, IROS 2013 (load-dependent friction of a gear).
"""

from collections.abc import Mapping

from bench.effects.effect import LOSSIEST
from bench.effects.signals import Axis, AxisState, Number, Values
from bench.effects.torque import Friction, FrictionLaw
from bench.units import Quantity


class LoadDependentFriction(Friction):
    name = "load_dependent_friction"
    summary = "friction grows with the magnitude of the transmitted torque"
    copies_torque = True
    quantities = (Quantity("load_friction_coefficient", "mu", "dimensionless", lower=0.0, upper=LOSSIEST, null=0.0),)
    looks_like = ("torque_scale",)

    def friction(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return values["load_friction_coefficient"] * abs(at.effort)

    def law(self, values: Mapping[str, float], axis: Axis) -> FrictionLaw:
        return FrictionLaw(motor=values["load_friction_coefficient"])


EFFECT = LoadDependentFriction()
