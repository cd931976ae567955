"""On which side of a soft coupling an outer load acts: drag, a spring, an unbalance, an event.

On the motor it stands in the balance as it is; on the load it shakes the coupling first. Its strength then also drives
the load's motion, so a fit brings the two in line.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.hypothesis import ELASTIC, Hypothesis
from bench.diagnose.soft_coupling import Acting
from bench.effects.catalogue import catalogue

Loads = tuple[tuple[float, ...], ...]


def outer_loads(hypothesis: Hypothesis) -> list[int]:
    """Indices of the effects that may act on the load of a soft coupling; none without one."""
    if ELASTIC not in hypothesis.names:
        return []
    known = catalogue()
    return [index for index, name in enumerate(hypothesis.names) if name in known and known[name].may_load]


def acting(hypothesis: Hypothesis) -> tuple[Acting, ...]:
    """What acts on the load, as far as its strengths are known."""
    loads = hypothesis.loads or ()
    return tuple(
        (catalogue()[hypothesis.effects[index].name], hypothesis.effects[index].shape, loads[index])
        for index in outer_loads(hypothesis)
        if index < len(loads) and loads[index]
    )


def loads_of(hypothesis: Hypothesis, theta: NDArray[np.float64], owners: NDArray[np.int64]) -> Loads | None:
    """Strengths over load inertia of what acts on the load, () of the others; None where nothing does."""
    if hypothesis.loads is None or ELASTIC not in hypothesis.names:
        return None
    inertia = float(theta[owners == hypothesis.names.index(ELASTIC)][0])
    loading = outer_loads(hypothesis) if inertia > 0.0 else []
    return tuple(
        tuple(float(value) for value in theta[owners == index] / inertia) if index in loading else ()
        for index in range(len(hypothesis.effects))
    )
