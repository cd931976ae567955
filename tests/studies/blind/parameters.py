"""True values of an effect in the quantities, and under the name, in which the diagnosis reports them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tests.studies.blind.run import Interval

#: Angles repeat.
ANGLES = ("phase",)
#: Whole numbers: right or wrong, no interval.
WHOLE = ("harmonic",)


@dataclass(frozen=True)
class Compared:
    """A reported quantity beside its true value; an angle's within half a turn of the reported one.

    Attributes:
        quantity: its name.
        true, value, low, high: truth, and what is reported with its 95 % interval - SI.
    """

    quantity: str
    true: float
    value: float
    low: float
    high: float

    @property
    def inside(self) -> bool:
        """Whether the interval holds the truth."""
        if self.quantity in WHOLE:
            return round(self.value) == round(self.true)
        return self.low <= self.true <= self.high

    @property
    def half_widths(self) -> float:
        """Error in half widths of the interval."""
        return abs(self.value - self.true) / max(0.5 * (self.high - self.low), 1e-300)

    @property
    def error(self) -> float:
        """Of an angle in rad, of all else relative to the true value; nan if that is zero."""
        if self.quantity in ANGLES:
            return abs(self.value - self.true)
        return abs(self.value / self.true - 1.0) if self.true else float("nan")


def expected(truth: Mapping, effect: str, named: str) -> dict[str, float]:
    """True values by reported quantity, of an effect that was named so (itself or what no recording tells from it).

    Args:
        truth: of the case, with its effects' parameters and its friction.
        effect: hidden.
        named: name in the diagnosis.
    """
    values = dict(truth["parameters"][effect])
    if effect == "direction_dependent_friction":
        # a relative difference s*d/(2*K_0) of viscous friction on either side of K_w
        share = values.pop("viscous_share", 0.0)
        difference = values["coulomb_difference"]
        values["viscous_difference"] = share * difference / truth["coulomb_friction"] * truth["viscous_friction"]
        if named == "torque_offset":
            return {"torque": difference / 2.0}
    elif effect == "torque_offset" and named == "direction_dependent_friction":
        return {"coulomb_difference": 2.0 * values["torque"], "viscous_difference": 0.0}
    return values


def compared(truth: Mapping, effect: str, named: str, reported: Mapping[str, Interval]) -> dict[str, Compared]:
    """Each reported quantity that the truth has, beside its true value."""
    true = expected(truth, effect, named)
    return {key: _beside(key, true[key], interval) for key, interval in reported.items() if key in true}


def _beside(quantity: str, true: float, interval: Interval) -> Compared:
    if quantity in ANGLES:
        true = interval[0] + float(np.angle(np.exp(1j * (true - interval[0]))))
    return Compared(quantity, true, *interval)
