"""Arrays of numbers, and what is asked of them everywhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: Numbers of any shape; a docstring says which.
Array = NDArray[np.float64]


def rms(values: Array) -> float:
    """Root mean square of all values, of any shape, in their unit."""
    return float(np.sqrt(np.mean(values**2)))


def column_rms(table: Array) -> Array:
    """Root mean square of each column (m,) of a table (n, m), in its unit."""
    return np.sqrt(np.mean(table**2, axis=0))


def recurrence(kept: Array, added: Array) -> Array:
    """y[k] = kept[k]*y[k - 1] + added[k] of a sequence that begins at zero (n,), by doubling the reach of each sum.

    Args:
        kept: (n,) from 0 to 1.
        added: (n,), any unit.
    """
    kept, found = kept.copy(), added.copy()
    reach = 1
    while reach < found.size and kept[reach:].any():
        found[reach:] += kept[reach:] * found[:-reach]
        kept[reach:] *= kept[:-reach]
        reach *= 2
    return found
