"""Figures and tests of statistics that are used all over the bench."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

from bench.arrays import Array

#: Half width of a normal distribution's 95 % interval in standard deviations.
NORMAL95 = NormalDist().inv_cdf(0.975)


def holm(chances: Array, silent: int = 0) -> Array:
    """Chances (n,) of several tests so raised that each one below a rate alarms falsely at that rate for all together.

    S. Holm, Scandinavian Journal of Statistics 6(2), 1979, 65-70; whatever hangs together.

    Args:
        chances: of each test, were nothing there (n,).
        silent: tests that were made too and cannot alarm.
    """
    order = np.argsort(chances, kind="stable")
    raised = (chances.size + silent - np.arange(chances.size)) * chances[order]
    found = np.empty_like(chances)
    found[order] = np.minimum(np.maximum.accumulate(raised), 1.0)
    return found
