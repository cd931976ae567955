"""Spread of a quantity between recordings of one axis, beyond the standard error of each, and where the next one lies.

Recordings differ by more than noise: temperature, lubricant, mounting of the load. The value from recording k is
modelled as theta + u_k + e_k; e_k has the recording's own standard error s_k, u_k the common variance tau**2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its special functions load when first used: 0.2 s

from bench.arrays import NORMAL95
from bench.parameter import Parameter

#: Probability of a false warning that recordings differ, over all quantities together.
ALARM = 0.01


@dataclass(frozen=True)
class Excess:
    """How much recordings differ beyond their own intervals.

    Attributes:
        variance: tau**2 - the quantity's unit squared.
        degrees: of freedom of this estimate; 0 if there is nothing to compare.
        chance: probability of such a spread if recordings differ by their own errors alone.
    """

    variance: float
    degrees: int
    chance: float

    @property
    def reach(self) -> float:
        """Half width of an interval of 95 % in standard deviations, by Student's t; 0 without a degree of freedom."""
        return float(scipy.special.stdtrit(self.degrees, 0.975)) if self.degrees else 0.0

    def of_joint(self, own: Sequence[Parameter]) -> float:
        """Standard error that the spread adds to a joint value, after averaging - the quantity's unit.

        The joint value weights estimates by each recording alone by 1/(s_k**2 + tau**2).
        """
        if not self.variance:
            return 0.0
        weights = 1.0 / (np.array([each.half_width / NORMAL95 for each in own]) ** 2 + self.variance)
        return math.sqrt(self.variance * float(weights @ weights)) / float(weights.sum())


def excess(groups: Sequence[Sequence[Parameter]]) -> Excess:
    """Variance between recordings by the method of moments, from Cochran's Q over groups of values, one a recording.

    tau**2 = max(0, (Q - degrees)/sum over groups of (sum w - sum w**2/sum w)), w = 1/s_k**2 (R. DerSimonian, N. Laird,
    Meta-analysis in clinical trials, Controlled Clinical Trials 7(3), 1986, 177-188). s_k is taken from the interval,
    which includes that it was itself estimated.
    """
    apart, expected, degrees = 0.0, 0.0, 0
    for group in groups:
        values = np.array([found.value for found in group])
        weights = 1.0 / np.maximum([found.half_width / NORMAL95 for found in group], 1e-150) ** 2
        if values.size < 2:
            continue
        apart += float(weights @ (values - weights @ values / weights.sum()) ** 2)
        expected += float(weights.sum() - weights @ weights / weights.sum())
        degrees += values.size - 1
    if not degrees:
        return Excess(0.0, 0, 1.0)
    return Excess(max(0.0, (apart - degrees) / expected), degrees, float(scipy.special.chdtrc(degrees, apart)))


@dataclass(frozen=True)
class Between:
    """How recordings of one axis differ in a quantity.

    Attributes:
        std_dev: standard deviation of the estimates by each recording alone - the quantity's unit.
        predictive95: prediction interval for one more recording, at 95 % - the quantity's unit.
    """

    std_dev: float
    predictive95: tuple[float, float]


def between(found: Sequence[Parameter]) -> Between:
    """Spread of the estimates by at least two recordings alone, and the prediction interval of the next one.

    The interval is never narrower than by the recordings' own errors.
    """
    values = np.array([each.value for each in found])
    spread, mean = float(np.std(values, ddof=1)), float(np.mean(values))
    own = float(np.sqrt(np.mean([each.half_width**2 for each in found])))
    reach = max(float(scipy.special.stdtrit(values.size - 1, 0.975)) * spread, own)
    return Between(spread, next_interval(mean, reach, values.size))


def next_interval(mean: float, reach: float, count: int) -> tuple[float, float]:
    """Prediction interval of the next value after `count`, mean -+ reach*sqrt(1 + 1/count) - the quantity's unit.

    With reach = t*s, s the standard deviation of the values and t Student's at its degrees of freedom, this is exact
    for normal values of one variance, whatever share of it is their own error (G. J. Hahn, W. Q. Meeker, Statistical
    Intervals, 1991, section 4.7).
    """
    wide = reach * math.sqrt(1.0 + 1.0 / count)
    return mean - wide, mean + wide


def spread_warning(name: str, own: Sequence[Parameter]) -> str:
    """A warning that recordings differ in a quantity by more than their own errors."""
    low, high = min(each.value for each in own), max(each.value for each in own)
    return (
        f"the recordings differ in {name} by more than their own intervals allow ({low:.4g} to {high:.4g} "
        f"{own[0].unit}): the joint interval counts it, `between` predicts the next recording"
    )
