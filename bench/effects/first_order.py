"""The first-order lag T*dy/dt + y = u, written once for all signals that pass one."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array, recursive_filter


def lagged(values: Array, time_constant: float, step: float) -> Array:
    """Values (n,) behind a lag, exact for an input that runs straight between samples; started in equilibrium.

    Args:
        values: (n,), any unit.
        time_constant: T - s.
        step: between samples - s.
    """
    decay = np.exp(-step / time_constant)
    mean = time_constant / step * (1.0 - decay)
    now, before = 1.0 - mean, mean - decay
    return recursive_filter([now, before], [1.0, -decay], values, held=values[0] * (1.0 - now))


def unlagged(values: Array, time_constant: float, step: float) -> Array:
    """What comes out behind a lag as these values (n,), by central differences: y + T*dy/dt.

    Args:
        values: (n,), any unit.
        time_constant: T - s.
        step: between samples - s.
    """
    return values + time_constant * np.gradient(values, step) if values.size > 1 else values
