"""The difference of two states in one quantity, and the tests on it.

    D = now - baseline ~ t(degrees) with variance  s_n**2/k_n + s_b**2/k_b + tau**2*(1/k_n + 1/k_b)

s - standard error of one recording; tau - additional standard deviation between recordings; k - number of recordings;
n, b - now and baseline. This is the prediction interval of the next recording (G. J. Hahn, W. Q. Meeker, Statistical
Intervals, 1991, section 4.7): with one recording now it is 1 + 1/k_b times the variance of one. The degrees of freedom
of the sum are Satterthwaite's (Biometrics Bulletin 2, 1946, 110-114).

Against a margin m there are three answers:

- same: the interval of 90 % lies within (-m, m). Two one-sided tests at 5 % (D. J. Schuirmann, J. Pharmacokinetics and
  Biopharmaceutics 15, 1987, 657-680); that all quantities are the same is shown at 5 % without a correction, as
  each one has to be (R. L. Berger, Technometrics 24, 1982, 295-300).
- changed: |D| exceeds m; its probability if the true |D| <= m is at most `Difference.chance(m)`, which
  `bench.statistics.holm` corrects for the number of comparisons.
- undecided: neither.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy import special

from bench.baseline.measured import Measured

#: Number of recordings in a baseline from which on the spread is theirs alone, by Student's t. With fewer it is the
#: larger of theirs and the stated one: at 2 degrees of freedom and 30 comparisons at 1 % an interval is 55 standard
#: deviations wide on each side, at 4 it is 10.
ENOUGH = 5
#: Probability that a quantity that differs by more than its margin is called the same.
NOT_EQUIVALENT = 0.05


@dataclass(frozen=True)
class Difference:
    """Now less baseline.

    Attributes:
        value, std_error: in the quantity's unit.
        degrees: of freedom.
    """

    value: float
    std_error: float
    degrees: float

    @classmethod
    def of(cls, baseline: Measured, now: Measured, between: float, beside: float = 0.0) -> Difference:
        """Difference with the variance above.

        Args:
            baseline, now: the quantity in both states.
            between: stated standard deviation between recordings - unit.
            beside: the same for a known difference of the states, such as their motion - unit.
        """
        parts = [(now.std_error**2 / now.recordings, now.degrees)]
        shares = 1.0 / now.recordings + 1.0 / baseline.recordings
        if baseline.spread is not None and baseline.recordings >= ENOUGH:
            total = baseline.spread**2  # own errors included
            more = max(0.0, now.std_error**2 - baseline.std_error**2) / now.recordings
            parts = [(total * shares, baseline.recordings - 1.0), (more, now.degrees)]
        else:
            shown = math.sqrt(max(0.0, (baseline.spread or 0.0) ** 2 - baseline.std_error**2))
            parts += [(baseline.std_error**2 / baseline.recordings, baseline.degrees)]
            parts += [(max(between, shown) ** 2 * shares, math.inf)]
        parts += [(2.0 * beside**2, math.inf)]
        variance = sum(part for part, _ in parts)
        shakiness = sum(part**2 / degrees for part, degrees in parts)
        degrees = variance**2 / shakiness if shakiness > 0.0 else math.inf
        return cls(now.value - baseline.value, math.sqrt(variance), degrees)

    def interval(self, level: float) -> tuple[float, float]:
        """Interval that contains the true difference with probability `level` - unit."""
        reach = _reach(self.degrees, level) * self.std_error
        return self.value - reach, self.value + reach

    def within(self, margin: float) -> bool:
        """Whether the difference is shown to be smaller than a margin."""
        low, high = self.interval(1.0 - 2.0 * NOT_EQUIVALENT)
        return -margin < low and high < margin

    def chance(self, margin: float) -> float:
        """Probability of a difference this large, in either direction, if the true one is within a margin."""
        if self.std_error == 0.0:
            return float(abs(self.value) <= margin)
        sides = ((abs(self.value) + side * margin) / self.std_error for side in (-1.0, 1.0))
        return min(1.0, sum(_tail(self.degrees, side) for side in sides))


def _tail(degrees: float, value: float) -> float:
    """Probability that Student's t exceeds a value."""
    return float(special.ndtr(-value) if math.isinf(degrees) else special.stdtr(degrees, -value))


def _reach(degrees: float, level: float) -> float:
    share = 0.5 * (1.0 + level)
    return float(special.ndtri(share) if math.isinf(degrees) else special.stdtrit(degrees, share))
