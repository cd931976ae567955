"""What every array of the bench is made of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def rms(values: Array) -> float:
    """Root mean square of values (n,), in their unit."""
    return float(np.sqrt(np.mean(values**2)))
