"""Friction warm-up: dry and viscous friction decay over time as the axis warms up.

    M = (K_0*sgn(omega) + K_w*omega)*(1 + A*exp(-t/T))

A - relative amplitude of the dry part, the viscous part may decay by another; T - time constant - s; t - time since the
recording's start - s.
"""

from collections.abc import Mapping, Sequence

from bench.arrays import namespace
from bench.effects.shape import DURATION, Shape
from bench.effects.signals import Axis, AxisState, Number, Values
from bench.effects.torque import Friction
from bench.units import Quantity

#: Share of the dry amplitude that viscous friction has where none is given.
ALL = 1.0
#: Dry friction that the cold axis has more, over that of the warm one, at most: far above what lubricants do.
COLDEST = 10.0


class FrictionWarmup(Friction):
    name = "friction_warmup"
    summary = "friction decays over time as the axis warms up"
    scales_friction = True
    quantities = (
        Quantity("relative_amplitude", "A", "dimensionless", lower=0.0, null=0.0),
        Quantity("time_constant", "T", "s", lower=0.0),
        Quantity("viscous_share", "s", "dimensionless", lower=0.0, preset=ALL, minor=True),
    )
    shapes = (Shape(quantities[1], (0.7, 1.5, 3.0, 6.0, 12.0), measure=DURATION),)

    def friction(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return at.friction * _cold(values, at)

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        """Viscous friction of the cold axis."""
        return values["viscous_share"] * _cold(values, at) * axis.viscous * at.velocity

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        """Amplitude relative to the Coulomb friction of the warm axis, and the same of viscous friction over it."""
        amplitude, viscous = strengths[0] / base.coulomb, base.viscous
        share = strengths[1] / (viscous * amplitude) if viscous > 0.0 and amplitude != 0.0 else ALL
        return {"relative_amplitude": amplitude, "time_constant": shape[0], "viscous_share": share}

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> bool:
        """Dry friction decays; how viscous friction does matters little where that is small."""
        return 0.0 < strengths[0] < COLDEST * base.coulomb


def _cold(values: Values, at: AxisState) -> Number:
    """A*exp(-t/T)."""
    passed = -at.time / values["time_constant"]
    return values["relative_amplitude"] * namespace(passed).exp(passed)


EFFECT = FrictionWarmup()
