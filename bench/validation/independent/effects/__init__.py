"""Effects of the independent axis: the contract's catalogue and some physics outside it."""

from bench.validation.independent.effects.effect import Effect, stack
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
from bench.validation.independent.effects.measurement import (
    CurrentFilterLag,
    CurrentGainAsymmetry,
    CurrentOffsetDrift,
    EncoderEccentricity,
    TorqueConstantDrift,
    VelocityFilterLag,
)
from bench.validation.independent.effects.motor import (
    CoggingTorque,
    CurrentLoopLag,
    TorqueConstantSaturation,
    TorqueRipple,
    VoltageLimit,
)
from bench.validation.independent.effects.outside import PositionNotch, RestHardening, SlowMemoryFriction, Vibration

KINDS: dict[str, type[Effect]] = {
    kind.name: kind
    for kind in (
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
        SlowMemoryFriction,
        PositionNotch,
        Vibration,
        RestHardening,
        CurrentFilterLag,
        CurrentGainAsymmetry,
        CurrentOffsetDrift,
        TorqueConstantDrift,
        DirectionalLoadFriction,
    )
}
#: Drawn as a group of their own, so that a case of another group stays what it is.
LATER = {
    kind.name: kind
    for kind in (
        CurrentFilterLag,
        CurrentGainAsymmetry,
        CurrentOffsetDrift,
        TorqueConstantDrift,
        DirectionalLoadFriction,
    )
}
CATALOGUE = {name: kind for name, kind in KINDS.items() if not kind.outside_catalogue and name not in LATER}
OUTSIDE = {name: kind for name, kind in KINDS.items() if kind.outside_catalogue}

__all__ = [
    "CATALOGUE",
    "KINDS",
    "LATER",
    "OUTSIDE",
    "Backlash",
    "CoggingTorque",
    "CurrentFilterLag",
    "CurrentGainAsymmetry",
    "CurrentLoopLag",
    "CurrentOffsetDrift",
    "DirectionDependentFriction",
    "DirectionalLoadFriction",
    "Effect",
    "ElasticCoupling",
    "EncoderEccentricity",
    "FrictionWarmup",
    "LoadDependentFriction",
    "LoadTorqueEvent",
    "PositionDependentFriction",
    "PositionDependentInertia",
    "PositionNotch",
    "PreslidingFriction",
    "QuadraticDrag",
    "RestHardening",
    "SlowMemoryFriction",
    "StribeckFriction",
    "TorqueConstantDrift",
    "TorqueConstantSaturation",
    "TorqueOffset",
    "TorqueRipple",
    "TorsionSpring",
    "Unbalance",
    "VelocityFilterLag",
    "Vibration",
    "VoltageLimit",
    "stack",
]
