"""What is left open of an estimate by the rig's tolerances, and by an effect too weak to be named."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.balance.fit import fit
from bench.balance.hint import hint
from bench.balance.rows import Rows
from bench.effects.catalogue import catalogue
from bench.identify.cutoffs import TERMS, Tried
from bench.identify.determined import only_direction
from bench.identify.solution import equations_of, solved_with_shift
from bench.rig.rig import Rig
from bench.trace.trace import Trace


def by_tolerance(first: Trace, rig: Rig, tried: Tried) -> Array:
    """How far intervals of 95 % have to reach for the rig's tolerances alone (p,), which are taken for independent.

    Args:
        first: the recording, or its first part.
        rig: of the axis.
        tried: the estimate of it at the cut-off taken.
    """
    offset = rig.offset and only_direction(tried.equations) is None
    others = tuple(rig.within_tolerance())
    moved = np.zeros(tried.equations.noise.shape[0] - (not offset))
    if not others:
        return moved
    theta = solved_with_shift(tried.equations, tried.rows, offset).theta
    for other in others:
        rows = Rows.of(first, other, conditioning=tried.rows.conditioning)
        found = solved_with_shift(equations_of(rows, tried.hypothesis), rows, offset).theta
        moved = np.hypot(moved, found - theta)
    return moved


def by_hint(tried: Tried) -> Array:
    """How far J, K_w and K_0 would move with the effect that a recording hints at (3,); 0 without one.

    Args:
        tried: the estimate of the recording, or of its first part, at the cut-off taken.
    """
    found = fit(tried.rows, tried.hypothesis)
    beside = hint(found, catalogue().values())
    places = [*TERMS.values()]
    return np.zeros(len(places)) if beside is None else beside.theta[places] - found.theta[places]
