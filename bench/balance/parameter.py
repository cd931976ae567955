"""An identified quantity with its interval."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from bench.statistics import NORMAL95


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
