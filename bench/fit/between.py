"""Spread of a quantity between recordings of one axis, beyond the standard error of each.

Recordings differ by more than noise: temperature, lubricant, mounting of the load. The value from recording k is
modelled as theta + u_k + e_k; e_k has the recording's own standard error s_k, u_k the common variance tau**2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from bench.fit.estimate import Between
from bench.fit.parameter import Parameter
from bench.statistics import NORMAL95

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
        return float(special.stdtrit(self.degrees, 0.975)) if self.degrees else 0.0


def excess(groups: Sequence[Sequence[Parameter]]) -> Excess:
    """Variance between recordings by the method of moments, from Cochran's Q over groups of comparable values.

    tau**2 = max(0, (Q - degrees)/sum over groups of (sum w - sum w**2/sum w)), w = 1/s_k**2 (R. DerSimonian, N. Laird,
    Meta-analysis in clinical trials, Controlled Clinical Trials 7(3), 1986, 177-188). s_k is taken from the interval,
    which includes that it was itself estimated.

    Args:
        groups: of comparable values, one per recording.
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
    return Excess(max(0.0, (apart - degrees) / expected), degrees, float(special.chdtrc(degrees, apart)))


def between(found: Sequence[Parameter]) -> Between:
    """Spread of the estimates by at least two recordings alone, and the prediction interval of the next one.

    mean +- t*s*sqrt(1 + 1/n), s the standard deviation of n values and t Student's at n - 1 degrees of freedom: exact
    for normal values of one variance, whatever share of it is their own error (G. J. Hahn, W. Q. Meeker, Statistical
    Intervals, 1991, section 4.7). The interval is never narrower than by the recordings' own errors.
    """
    values = np.array([each.value for each in found])
    spread, mean = float(np.std(values, ddof=1)), float(np.mean(values))
    own = float(np.sqrt(np.mean([each.half_width**2 for each in found])))
    reach = max(float(special.stdtrit(values.size - 1, 0.975)) * spread, own) * math.sqrt(1.0 + 1.0 / values.size)
    return Between(spread, (mean - reach, mean + reach))


def widened(found: Parameter, apart: Excess, own: Sequence[Parameter]) -> Parameter:
    """A joint value whose interval includes the spread between recordings, as far as averaging leaves it.

    Args:
        found: with its interval from the recordings' own errors.
        apart: spread of the recordings beyond these.
        own: estimate by each recording alone.
    """
    if not apart.variance:
        return found
    weights = 1.0 / (np.array([each.half_width / NORMAL95 for each in own]) ** 2 + apart.variance)
    more = math.sqrt(apart.variance * float(weights @ weights)) / float(weights.sum())
    reach = math.hypot(found.half_width, apart.reach * more)
    interval = (found.value - reach, found.value + reach)
    return replace(found, std_error=math.hypot(found.std_error, more), ci95=interval)


def spread_warning(name: str, own: Sequence[Parameter]) -> str:
    """A warning that recordings differ in a quantity by more than their own errors."""
    low, high = min(each.value for each in own), max(each.value for each in own)
    return (
        f"the recordings differ in {name} by more than their own intervals say ({low:.4g} to {high:.4g} "
        f"{own[0].unit}): the joint interval counts it, `between` says what the next one may tell"
    )
