"""Torque scale: reported torque is a multiple of the torque that acts, as by a wrong torque constant.

    M = M_reported/s

s - scale - dimensionless; M - torque that acts, M_reported - reported torque - N*m (N). A scale is one with inertia and
friction unless a torque is known: so it is sought where an MJCF gives the weight of the links, or a payload. Links that
are s times as heavy as in the MJCF look alike, but for armature and friction, which are then s times as large.
"""

from collections.abc import Mapping, Sequence

from bench.effects.effect import Stage
from bench.effects.signals import Axis, AxisState, Number, Scope, Values
from bench.effects.torque import Torque
from bench.trace.signals import KNOWN_TORQUE
from bench.units import Quantity


class TorqueScale(Torque):
    name = "torque_scale"
    summary = "reported torque is a multiple of the torque that acts"
    stage = Stage.CURRENT_SENSOR
    rescales_torque = True
    quantities = (Quantity("scale", "s", "dimensionless", lower=0.2, upper=5.0, null=1.0),)
    looks_like = ("unbalance", "load_dependent_friction")

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """What the reading has too much; its strength is 1/s - 1."""
        return at.effort - at.effort / values["scale"]

    def sought(self, scope: Scope) -> bool:
        return KNOWN_TORQUE in scope.signals

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        return {"scale": 1.0 / max(1.0 + strengths[0], 1e-9)}


EFFECT = TorqueScale()
