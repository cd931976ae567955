"""True values of an effect in the quantities, and under the name, in which the diagnosis reports them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tests.blind.run import Interval

#: Angles repeat; a sine's amplitude may be reported with the opposite sign only if its phase says so.
ANGLES = ("phase",)
#: Whole numbers: right or wrong, no interval.
WHOLE = ("harmonic",)


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


def inside(truth: Mapping, effect: str, named: str, reported: Mapping[str, Interval]) -> dict[str, bool]:
    """Whether the interval of each reported quantity holds the true value."""
    true = expected(truth, effect, named)
    return {key: _holds(key, true[key], interval) for key, interval in reported.items() if key in true}


def _holds(quantity: str, true: float, interval: Interval) -> bool:
    value, low, high = interval
    if quantity in WHOLE:
        return round(value) == round(true)
    if quantity in ANGLES:
        true = value + float(np.angle(np.exp(1j * (true - value))))
    return low <= true <= high
