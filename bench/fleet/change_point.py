"""The largest step in a series of values of one axis over its error, and where the next one is.

A series of recordings may step at some time:

    v_k = theta + step*(k >= c) + u_k + e_k

v_k - value of recording k, in the order of time; e_k - its own error, of standard error s_k; u_k - by what recordings
differ anyway, of one variance. For every place c the step is the difference of the means on both sides, its variance
p/c + p/(n - c) with p the variance pooled about the two means, but on neither side below that of the recordings' own
errors, and Student's t at n - 2 degrees of freedom judges it: with one recording behind c this is the prediction
interval of the next recording (`bench.comparison.spread.next_interval`). The chance of the largest of n - 1 steps is at
most n - 1 times its own (Bonferroni). Means are not weighted: weights by estimated variances alarm on up to three times
the share they claim where errors differ much.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its special functions load when first used: 0.2 s

from bench.arrays import Array
from bench.comparison.spread import next_interval

#: Recordings below which nothing can be concluded: two means, and one number for the scatter about them.
FEWEST = 3


@dataclass(frozen=True)
class ChangePoint:
    """The most significant step of a series of values.

    Attributes:
        place: of the first recording after it.
        before, after: means on both sides - the quantity's unit.
        reach: half width of the interval of 95 % of their difference - the same.
        size: their difference in standard errors.
        chance: that a series without a step shows one as significant, at most.
    """

    place: int
    before: float
    after: float
    reach: float
    size: float
    chance: float


def change_point(values: Array, errors: Array) -> ChangePoint | None:
    """The most significant step of values in the order of time (n,) with errors (n,); None of fewer than three."""
    n = values.size
    if n < FEWEST:
        return None
    centre = values.mean()
    away = values - centre
    counts = np.array([np.arange(1, n), np.arange(n - 1, 0, -1)])
    reached, own = np.cumsum(away)[:-1], np.cumsum(errors**2)
    means = np.array([reached, -reached]) / counts
    pooled = np.maximum(away @ away - (counts * means**2).sum(axis=0), 0.0) / (n - 2)
    least = np.array([own[:-1], own[-1] - own[:-1]]) / counts**2
    error = np.sqrt(np.maximum(pooled / counts, least).sum(axis=0))
    steps = means[1] - means[0]
    sizes = np.abs(steps) / np.maximum(error, 1e-150)
    best = int(np.argmax(sizes))
    return ChangePoint(
        place=best + 1,
        before=float(centre + means[0, best]),
        after=float(centre + means[1, best]),
        reach=float(scipy.special.stdtrit(n - 2, 0.975) * error[best]),
        size=float(sizes[best]),
        chance=min(1.0, (n - 1) * 2.0 * float(scipy.special.stdtr(n - 2, -sizes[best]))),
    )


def expected(values: Array, errors: Array, *steps: int) -> list[tuple[float, float]]:
    """Intervals of 95 % of the next recording, as those before, between and after steps have it - the quantity's unit.

    Their scatter is the variance pooled about all means, or that of the recordings' own errors (n,), n > steps + 1.
    """
    sides = np.split(values, steps)
    degrees = values.size - len(sides)
    pooled = sum(float(((side - side.mean()) ** 2).sum()) for side in sides) / degrees
    student = float(scipy.special.stdtrit(degrees, 0.975))

    def interval(side: Array, own: Array) -> tuple[float, float]:
        reach = student * max(pooled, float(np.mean(own**2))) ** 0.5
        return next_interval(float(side.mean()), reach, side.size)

    return [interval(side, own) for side, own in zip(sides, np.split(errors, steps), strict=True)]
