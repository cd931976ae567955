"""pint's registry: reads every name of a unit that is not usual."""

from __future__ import annotations

import math
from functools import cache
from tokenize import TokenError

import pint

#: What pint raises on names that are no unit.
_NO_UNIT = (
    pint.errors.PintError,
    AttributeError,
    LookupError,
    TypeError,
    ValueError,
    AssertionError,
    ArithmeticError,
    TokenError,
)


@cache
def _registry() -> pint.UnitRegistry:
    registry = pint.UnitRegistry(cache_folder=None)
    registry.define("rpm = revolution / minute")
    return registry


def by_pint(name: str) -> tuple[float, float, dict[str, float], str]:
    """Factor and offset to SI of a unit's name, its exponents by dimension, and the unit without its prefix.

    The factor of a logarithm, such as dB, is nan.

    Raises:
        ValueError: pint knows no such unit.
    """
    registry = _registry()
    try:
        unit = registry.Unit(name)
        zero, one, two = (float(registry.Quantity(value, unit).to_base_units().magnitude) for value in (0.0, 1.0, 2.0))
        powers = {dimension: float(str(power)) for dimension, power in unit.dimensionality.items()}
        ((full, _),) = registry.Quantity(1.0, unit).unit_items()
        base = registry.parse_unit_name(full)[0][1]
    except _NO_UNIT as error:
        raise ValueError(f"'{name}' is not a unit") from error
    linear = math.isclose(two - one, one - zero, rel_tol=1e-9)
    return one - zero if linear else math.nan, zero if linear else 0.0, powers, base
