"""A quantity in one state of an axis: value, standard error, and spread between recordings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.fit.parameter import Parameter


@dataclass(frozen=True)
class Measured:
    """A quantity of an axis.

    Attributes:
        value: in `unit`.
        unit: SI.
        std_error: standard error of one such recording from its own noise; 0 if exact - unit.
        degrees: of freedom of this error; inf if it is known.
        recordings: number of recordings that determine the quantity alone.
        spread: standard deviation of their estimates, own errors included; None for fewer than two - unit.
    """

    value: float
    unit: str
    std_error: float
    degrees: float = math.inf
    recordings: int = 1
    spread: float | None = None

    @classmethod
    def of(cls, found: Parameter, alone: Sequence[Parameter] = ()) -> Measured:
        """From a quantity with its interval, and from its estimates by each of several recordings alone.

        The degrees of freedom are those at which Student's t gives the width of the interval of 95 %. Of several
        recordings the error is the root mean square of theirs.
        """
        known = [one for one in alone if math.isfinite(one.std_error)]
        if len(known) < 2:
            return cls(found.value, found.unit, found.std_error, found.degrees)
        error = float(np.sqrt(np.mean([one.std_error**2 for one in known])))
        spread = float(np.std([one.value for one in known], ddof=1))
        return cls(found.value, found.unit, error, min(one.degrees for one in known), len(known), spread)
