"""What the rig's tolerances leave open of an estimate: it is formed again with each value at the end of its own."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.balance.rows import Rows
from bench.identify.cutoffs import Tried
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
    theta = solved_with_shift(tried.equations, tried.rows, offset).theta
    moved = np.zeros(theta.size)
    for other in rig.within_tolerance():
        rows = Rows.of(first, other, conditioning=tried.rows.conditioning)
        found = solved_with_shift(equations_of(rows, tried.hypothesis), rows, offset).theta
        moved = np.hypot(moved, found - theta)
    return moved
