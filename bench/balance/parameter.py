"""An identified quantity with its interval."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from scipy import special

from bench.statistics import NORMAL95

#: Of the interval that is told.
LEVEL = 0.95
#: Share by which a reach may exceed a normal distribution's and count as one: its degrees are beyond what can be told.
NORMAL = 1e-6


@dataclass(frozen=True)
class Parameter:
    """An identified quantity.

    Attributes:
        value: in `unit`.
        unit: SI, or built from the unit the effort was allowed in (A*s**2/rad, ...).
        std_error: standard error - unit; nan where the estimator knows none.
        ci95: 95 % interval - unit.
    """

    value: float
    unit: str
    std_error: float
    ci95: tuple[float, float]

    def interval(self, level: float) -> tuple[float, float]:
        """The interval of another level - unit.

        Half width over standard error at 95 % is that of a Student's t, of as many degrees of freedom as give it; the
        same t gives the other levels. Without correlation that matters and without `widened` those are the degrees of
        the covariance; a wide margin beside the covariance is taken for a normal distribution's.

        Args:
            level: 0 to 1, both excluded.
        """
        if level == LEVEL or not self.std_error > 0.0:
            return self.ci95
        reach = 0.5 * (self.ci95[1] - self.ci95[0]) / self.std_error
        student = reach > NORMAL95 * (1.0 + NORMAL)
        degrees = float(special.stdtridf(0.5 + 0.5 * LEVEL, reach)) if student else math.inf
        share = float(special.stdtrit(degrees, 0.5 + 0.5 * level)) / reach
        low, high = (self.value + share * (bound - self.value) for bound in self.ci95)
        return low, high

    def widened(self, *by: float) -> Parameter:
        """The same, its interval of 95 % wider by what else may move the value so far, independently - unit."""
        reach = math.hypot(*by)
        low, high = (math.hypot(bound - self.value, reach) for bound in self.ci95)
        error = math.hypot(self.std_error, reach / NORMAL95)
        return replace(self, std_error=error, ci95=(self.value - low, self.value + high))

    def reaching(self, other: float) -> Parameter:
        """The same, its interval as far as one around another value that may be the right one instead - unit."""
        away, (low, high) = other - self.value, self.ci95
        error = math.hypot(self.std_error, 0.5 * away)
        return replace(self, std_error=error, ci95=(min(low, low + away), max(high, high + away)))
