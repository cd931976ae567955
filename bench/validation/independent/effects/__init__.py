"""Effects of the independent axis: those of the bench's catalogue."""

import numpy as np

from bench.validation.independent.effects import electronics, mechanics
from bench.validation.independent.effects.effect import Effect

_LATER = (
    electronics.CurrentFilterLag,
    electronics.CurrentGainAsymmetry,
    electronics.CurrentOffsetDrift,
    electronics.TorqueConstantDrift,
    mechanics.DirectionalLoadFriction,
)
#: Drawn as a group of their own, so that a case of another group stays what it is.
LATER = {kind.name: kind for kind in _LATER}
CATALOGUE = {kind.name: kind for kind in Effect.__subclasses__() if kind not in _LATER}
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
