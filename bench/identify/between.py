"""What several recordings of one axis say of a quantity beyond what each of them knows of its own error.

Recordings differ by more than noise: temperature, lubricant, how the load was mounted. A value of recording k is taken
as theta + u_k + e_k; e_k has the recording's own standard error s_k, u_k the variance tau**2 that all share.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from bench.balance.parameter import Parameter
from bench.identify.estimate import Between
from bench.statistics import NORMAL95

#: Chance of being told that recordings differ which do not, of all quantities together.
ALARM = 0.01


@dataclass(frozen=True)
class Excess:
    """How much more recordings differ than their own intervals say.

    Attributes:
        variance: tau**2 - the quantity's unit squared; 0 where they do not.
        degrees: of freedom that it was read from; 0 where there was nothing to compare.
        chance: that recordings which differ by their own errors alone are this far apart.
    """

    variance: float
    degrees: int
    chance: float

    @property
    def reach(self) -> float:
        """Of an interval of 95 % in standard deviations, by Student's t; 0 without a degree of freedom."""
        return float(special.stdtrit(self.degrees, 0.975)) if self.degrees else 0.0


def excess(groups: Sequence[Sequence[Parameter]]) -> Excess:
    """Variance between recordings by the method of moments, from Cochran's Q over groups of comparable values.

    tau**2 = max(0, (Q - degrees)/sum over groups of (sum w - sum w**2/sum w)), w = 1/s_k**2 (R. DerSimonian, N. Laird,
    Meta-analysis in clinical trials, Controlled Clinical Trials 7(3), 1986, 177-188). s_k is taken from the interval,
    which counts that it was itself estimated.

    Args:
        groups: of values that would be the same, were the recordings alike.
    """
    apart, expected, degrees = 0.0, 0.0, 0
    for group in groups:
        values = np.array([found.value for found in group])
        weights = 1.0 / np.maximum([half_width(found) / NORMAL95 for found in group], 1e-150) ** 2
        if values.size < 2:
            continue
        apart += float(weights @ (values - weights @ values / weights.sum()) ** 2)
        expected += float(weights.sum() - weights @ weights / weights.sum())
        degrees += values.size - 1
    if not degrees:
        return Excess(0.0, 0, 1.0)
    return Excess(max(0.0, (apart - degrees) / expected), degrees, float(special.chdtrc(degrees, apart)))


def between(found: Sequence[Parameter]) -> Between:
    """Spread of what at least two recordings tell alone, and where the next one is to be expected.

    mean +- t*s*sqrt(1 + 1/n), s the standard deviation of n values and t Student's at n - 1 degrees of freedom: exact
    for normal values of one variance, whatever share of it is their own error (G. J. Hahn, W. Q. Meeker, Statistical
    Intervals, 1991, section 4.7). Values that agree by chance predict no better than their own errors let them.
    """
    values = np.array([each.value for each in found])
    spread, mean = float(np.std(values, ddof=1)), float(np.mean(values))
    own = float(np.sqrt(np.mean([half_width(each) ** 2 for each in found])))
    reach = max(float(special.stdtrit(values.size - 1, 0.975)) * spread, own) * math.sqrt(1.0 + 1.0 / values.size)
    return Between(spread, (mean - reach, mean + reach))


def widened(found: Parameter, apart: Excess, own: Sequence[Parameter]) -> Parameter:
    """A joint value whose interval counts by what recordings differ, as far as its weights do not average it out.

    Args:
        found: with the interval that the recordings' own errors give it.
        apart: by how much recordings differ beyond these.
        own: what each recording tells alone.
    """
    if not apart.variance:
        return found
    weights = 1.0 / (np.array([half_width(each) / NORMAL95 for each in own]) ** 2 + apart.variance)
    more = math.sqrt(apart.variance * float(weights @ weights)) / float(weights.sum())
    reach = math.hypot(half_width(found), apart.reach * more)
    interval = (found.value - reach, found.value + reach)
    return replace(found, std_error=math.hypot(found.std_error, more), ci95=interval)


def spread_warning(name: str, own: Sequence[Parameter]) -> str:
    """That recordings differ in a quantity by more than they know of their own errors."""
    low, high = min(each.value for each in own), max(each.value for each in own)
    return (
        f"the recordings differ in {name} by more than their own intervals say ({low:.4g} to {high:.4g} "
        f"{own[0].unit}): the joint interval counts it, `between` says what the next one may tell"
    )


def half_width(found: Parameter) -> float:
    """Of the interval of 95 % - the parameter's unit."""
    return 0.5 * (found.ci95[1] - found.ci95[0])
