"""Uncertainty of an estimate from the rig's tolerances, and from an effect too weak to be named."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.effects.catalogue import catalogue
from bench.fit.cutoffs import TERMS, Tried
from bench.fit.determined import only_direction
from bench.fit.fit import fit
from bench.fit.hint import hint
from bench.fit.rows import Rows
from bench.fit.solution import equations_of, solved_with_shift
from bench.rig.rig import Rig
from bench.trace.trace import Trace


def by_tolerance(first: Trace, rig: Rig, tried: Tried) -> Array:
    """Half widths at 95 % from the rig's tolerances alone (p,), which are assumed independent.

    Args:
        first: the recording, or its first part.
        rig: of the axis.
        tried: its estimate at the chosen cut-off.
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
    """By how much the effect that a recording hints at would move J, K_w and K_0 (3,); 0 without one.

    Args:
        tried: the estimate of the recording, or of its first part, at the chosen cut-off.
    """
    found = fit(tried.rows, tried.hypothesis)
    beside = hint(found, catalogue().values())
    places = [*TERMS.values()]
    return np.zeros(len(places)) if beside is None else beside.theta[places] - found.theta[places]
