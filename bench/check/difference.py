"""The difference of two states in one quantity, and what may be said of it.

    D = now - baseline ~ t(degrees) with variance  s_n**2/k_n + s_b**2/k_b + tau**2*(1/k_n + 1/k_b)

s - own standard error of a recording; tau - standard deviation between recordings beyond it; k - recordings; n, b - now
and baseline. This is the prediction interval of the next recording (G. J. Hahn, W. Q. Meeker, Statistical Intervals,
1991, section 4.7): with one recording now it is 1 + 1/k_b times the variance of one. The degrees of freedom of the sum
are Satterthwaite's (Biometrics Bulletin 2, 1946, 110-114).

Against a margin m three answers are possible, as D's interval lies inside, outside, or across its edge:

- same: the interval of 90 % lies within (-m, m). Two one-sided tests at 5 % (D. J. Schuirmann, J. Pharmacokinetics and
  Biopharmaceutics 15, 1987, 657-680); that all quantities are the same is shown at 5 % without a correction, as
  each one has to be (R. L. Berger, Technometrics 24, 1982, 295-300).
- changed: |D| is larger than m; its chance under |true D| <= m is at most `Difference.chance(m)`, and these are held
  against the family's rate by `bench.statistics.holm`.
- undecided: neither.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy import special

from bench.check.measured import Measured

#: Recordings of a baseline from which on the spread between them is theirs alone, by Student's t. Of fewer it is the
#: larger of what they show and what is stated: at 2 degrees of freedom and 30 comparisons at 1 % an interval reaches
#: 55 standard deviations, at 4 it reaches 10.
ENOUGH = 5
#: Chance that a quantity which differs by more than its margin is called the same.
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
            beside: the same of what differs between the states for a known reason, as their motion - unit.
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
        """That holds the true difference with a probability."""
        reach = _reach(self.degrees, level) * self.std_error
        return self.value - reach, self.value + reach

    def within(self, margin: float) -> bool:
        """Whether the difference is shown to be smaller than a margin."""
        low, high = self.interval(1.0 - 2.0 * NOT_EQUIVALENT)
        return -margin < low and high < margin

    def chance(self, margin: float) -> float:
        """That a true difference of at most a margin shows one this large, either way."""
        if self.std_error == 0.0:
            return float(abs(self.value) <= margin)
        sides = ((abs(self.value) + side * margin) / self.std_error for side in (-1.0, 1.0))
        return min(1.0, sum(_tail(self.degrees, side) for side in sides))


def _tail(degrees: float, value: float) -> float:
    """Chance that Student's t exceeds a value."""
    return float(special.ndtr(-value) if math.isinf(degrees) else special.stdtr(degrees, -value))


def _reach(degrees: float, level: float) -> float:
    share = 0.5 * (1.0 + level)
    return float(special.ndtri(share) if math.isinf(degrees) else special.stdtrit(degrees, share))
