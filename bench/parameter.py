"""An identified quantity with its interval."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy  # its special functions load when first used: 0.2 s
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import DTypeLike, NDArray

from bench.arrays import NORMAL95
from bench.names import short
from bench.presented import ByName

#: Level of the interval that is reported.
LEVEL = 0.95
#: Share by which a half width may exceed that of a normal distribution and still count as one.
NORMAL = 1e-6
#: How much further up than down an interval goes from which on both ends are given.
LOPSIDED = 2.0


@dataclass(frozen=True)
class Parameter(ByName, NDArrayOperatorsMixin):
    """An identified quantity; in arithmetic, comparisons and functions of NumPy it is its value.

    Attributes:
        value: in `unit`.
        unit: SI, or built from the unit the effort was allowed in (A*s**2/rad, ...).
        std_error: standard error - unit; nan where the estimator has none.
        ci95: 95 % interval - unit.
    """

    value: float
    unit: str
    std_error: float
    ci95: tuple[float, float]

    @classmethod
    def around(cls, value: float, unit: str, std_error: float, half: float) -> Parameter:
        """A value whose interval reaches half its width to each side - unit."""
        return cls(value, unit, std_error, (value - half, value + half))

    def __float__(self) -> float:
        return float(self.value)

    def __round__(self, digits: int = 0) -> float:
        return round(float(self.value), digits)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.value, dtype=dtype)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: object, **options: object) -> Any:  # noqa: ANN401
        values = tuple(one.value if isinstance(one, Parameter) else one for one in inputs)
        try:
            return getattr(ufunc, method)(*values, **options)
        except TypeError as error:
            found = " and ".join(short(repr(one), 40) for one in inputs if one is not self)
            allowed = f"allowed: numbers and arrays in {self.unit}"
            raise TypeError(f"{ufunc.__name__} of a parameter: found {found}; {allowed}") from error

    def __str__(self) -> str:
        if self.lopsided:
            low, high = (f"{bound:.{self.digits}g}" for bound in self.ci95)
            return f"{self.value:.3g} ({low} to {high}) {self.unit}"
        known = math.isfinite(self.half_width) and self.half_width > 0.0
        between = f" ± {self.half_width:.2g}" if known else ""
        return f"{self.value:.6g}{between} {self.unit.replace('dimensionless', '')}".rstrip()

    def __format__(self, form: str) -> str:
        return format(self.value, form) if form else str(self)

    @property
    def half_width(self) -> float:
        """Half width of the 95 % interval - unit."""
        return 0.5 * (self.ci95[1] - self.ci95[0])

    @property
    def lopsided(self) -> bool:
        """Whether the interval is one of a factor, so wide that half of it means little."""
        low, high = self.ci95
        return 0.0 < low < self.value and LOPSIDED * (self.value - low) < high - self.value < math.inf

    @property
    def digits(self) -> int:
        """Digits of the ends of the interval that show its width, two at least."""
        return 2 + max(0, math.floor(math.log10(self.ci95[1] / (self.ci95[1] - self.ci95[0]))))

    @property
    def degrees(self) -> float:
        """Degrees of freedom of the Student's t that has this half width; inf for a normal distribution."""
        reach = self.half_width / self.std_error if self.std_error > 0.0 else NORMAL95
        student = reach > NORMAL95 * (1.0 + NORMAL)
        return float(scipy.special.stdtridf(0.5 + 0.5 * LEVEL, reach)) if student else math.inf

    def interval(self, level: float) -> tuple[float, float]:
        """The interval of another level, between 0 and 1 - unit - by Student's t with the same degrees of freedom.

        Without significant correlation and without `widened` those are the degrees of the covariance; a wide margin in
        addition to the covariance is treated as normally distributed.
        """
        if level == LEVEL or not self.std_error > 0.0:
            return self.ci95
        share = float(scipy.special.stdtrit(self.degrees, 0.5 + 0.5 * level)) / (self.half_width / self.std_error)
        low, high = (self.value + share * (bound - self.value) for bound in self.ci95)
        return low, high

    def at(self, value: float, positive: bool) -> Parameter:
        """The same of another value: its interval keeps its width, or its factors where it is known up to those."""
        factors = positive and self.value != 0.0
        low, high = (bound / self.value * value if factors else bound - self.value + value for bound in self.ci95)
        return replace(self, value=value, ci95=(low, high))

    def times(self, factor: float) -> Parameter:
        """The same times a positive factor without a unit."""
        low, high = (factor * bound for bound in self.ci95)
        return replace(self, value=factor * self.value, std_error=factor * self.std_error, ci95=(low, high))

    def widened(self, *by: float) -> Parameter:
        """The same with independent errors of these half widths at 95 % added - unit."""
        reach = math.hypot(*by)
        low, high = (math.hypot(bound - self.value, reach) for bound in self.ci95)
        error = math.hypot(self.std_error, reach / NORMAL95)
        return replace(self, std_error=error, ci95=(self.value - low, self.value + high))

    def reaching(self, other: float) -> Parameter:
        """The same, its interval extended to cover one around another possible value - unit."""
        away, (low, high) = other - self.value, self.ci95
        error = math.hypot(self.std_error, 0.5 * away)
        return replace(self, std_error=error, ci95=(min(low, low + away), max(high, high + away)))
