"""Effects of the independent axis: the contract's catalogue and some physics outside it."""

from bench.validation.independent.effects.effect import Effect
from bench.validation.independent.effects.electronics import (
    CoggingTorque,
    CurrentFilterLag,
    CurrentGainAsymmetry,
    CurrentLoopLag,
    CurrentOffsetDrift,
    EncoderEccentricity,
    TorqueConstantDrift,
    TorqueConstantSaturation,
    TorqueRipple,
    VelocityFilterLag,
    VoltageLimit,
)
from bench.validation.independent.effects.friction import (
    DirectionalLoadFriction,
    DirectionDependentFriction,
    FrictionWarmup,
    LoadDependentFriction,
    PositionDependentFriction,
    PreslidingFriction,
    QuadraticDrag,
    StribeckFriction,
)
from bench.validation.independent.effects.load import (
    Backlash,
    ElasticCoupling,
    LoadTorqueEvent,
    PositionDependentInertia,
    TorqueOffset,
    TorsionSpring,
    Unbalance,
)
from bench.validation.independent.effects.outside import PositionNotch, RestHardening, SlowMemoryFriction, Vibration


def _by_name(*kinds: type[Effect]) -> dict[str, type[Effect]]:
    return {kind.name: kind for kind in kinds}


CATALOGUE = _by_name(
    StribeckFriction,
    PreslidingFriction,
    DirectionDependentFriction,
    QuadraticDrag,
    LoadDependentFriction,
    PositionDependentFriction,
    FrictionWarmup,
    TorqueOffset,
    Unbalance,
    TorsionSpring,
    PositionDependentInertia,
    ElasticCoupling,
    Backlash,
    LoadTorqueEvent,
    CoggingTorque,
    TorqueRipple,
    TorqueConstantSaturation,
    VoltageLimit,
    CurrentLoopLag,
    VelocityFilterLag,
    EncoderEccentricity,
)
OUTSIDE = _by_name(SlowMemoryFriction, PositionNotch, Vibration, RestHardening)
#: Drawn as a group of their own, so that a case of another group stays what it is.
LATER = _by_name(
    CurrentFilterLag, CurrentGainAsymmetry, CurrentOffsetDrift, TorqueConstantDrift, DirectionalLoadFriction
)
KINDS = CATALOGUE | OUTSIDE | LATER
