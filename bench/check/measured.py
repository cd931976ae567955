"""A quantity as one state of an axis tells it: value, error, and how recordings differ in it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from bench.balance.parameter import Parameter
from bench.statistics import NORMAL95


@dataclass(frozen=True)
class Measured:
    """A quantity of an axis.

    Attributes:
        value: in `unit`.
        unit: SI.
        std_error: standard error of one recording like these by its own noise; 0 of a number that is exact - unit.
        degrees: of freedom that this error was read from; inf where it is known.
        recordings: that tell the quantity alone.
        spread: standard deviation of what they tell alone, their own errors included; None of fewer than two - unit.
    """

    value: float
    unit: str
    std_error: float
    degrees: float = math.inf
    recordings: int = 1
    spread: float | None = None

    @classmethod
    def of(cls, found: Parameter, alone: Sequence[Parameter] = ()) -> Measured:
        """A quantity with its interval, and what each of several recordings tells of it alone.

        The degrees of freedom are those at which Student's t reaches as far as the interval of 95 % does. Of several
        recordings the error is that of one of them: the root of their mean variance.
        """
        known = [one for one in alone if math.isfinite(one.std_error)]
        if len(known) < 2:
            return cls(found.value, found.unit, found.std_error, _degrees(found))
        error = float(np.sqrt(np.mean([one.std_error**2 for one in known])))
        spread = float(np.std([one.value for one in known], ddof=1))
        return cls(found.value, found.unit, error, min(map(_degrees, known)), len(known), spread)


def _degrees(found: Parameter) -> float:
    """Degrees of freedom of an interval of 95 %; inf where it is a normal distribution's."""
    half = 0.5 * (found.ci95[1] - found.ci95[0])
    reach = half / found.std_error if found.std_error > 0.0 else NORMAL95
    if not reach > NORMAL95 * (1.0 + 1e-6):
        return math.inf
    return float(special.stdtridf(0.975, reach))
