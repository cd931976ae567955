"""Effects of the independent axis: those of the bench's catalogue."""

import numpy as np

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
from bench.validation.independent.effects.mechanics import (
    Backlash,
    DirectionalLoadFriction,
    DirectionDependentFriction,
    ElasticCoupling,
    FrictionWarmup,
    LoadDependentFriction,
    LoadTorqueEvent,
    PositionDependentFriction,
    PositionDependentInertia,
    PreslidingFriction,
    QuadraticDrag,
    StribeckFriction,
    TorqueOffset,
    TorsionSpring,
    Unbalance,
)


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
#: Drawn as a group of their own, so that a case of another group stays what it is.
LATER = _by_name(
    CurrentFilterLag, CurrentGainAsymmetry, CurrentOffsetDrift, TorqueConstantDrift, DirectionalLoadFriction
)
KINDS = CATALOGUE | LATER


def any_effects(
    count: int, rng: np.random.Generator, *, linear: bool = False, without: frozenset[str] = frozenset()
) -> tuple[str, ...]:
    """Names of `count` effects of the catalogue that can be hidden together, on a linear axis or without some."""
    allowed = [name for name, kind in CATALOGUE.items() if (kind.on_linear_axis or not linear) and name not in without]
    while True:
        names = tuple(str(name) for name in rng.choice(allowed, count, replace=False))
        if not any(KINDS[name].never_beside in names for name in names):
            return names
