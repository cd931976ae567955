"""pint's registry: reads every unit that is not in the table of usual ones."""

from __future__ import annotations

from functools import cache
from tokenize import TokenError

import pint

from bench.units.grammar import require_unit

#: What pint raises on texts that are no unit.
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


#: Order in which dimensions are written; pint's own depends on how the unit was composed.
_ORDER = ("[mass]", "[length]", "[time]", "[current]", "[temperature]", "[substance]", "[luminosity]")


@cache
def _unit(unit: str) -> pint.Unit:
    require_unit(unit)
    return _registry().Unit(unit)


def dimensionality(unit: str) -> str:
    """Dimension of a unit, e.g. `[length] / [time]`; ValueError if `unit` is no unit."""
    try:
        dimensions = dict(_unit(unit).dimensionality)
    except _NO_UNIT as error:
        raise ValueError(f"'{unit}' is not a unit") from error
    known = sorted(dimensions, key=lambda name: (_ORDER.index(name) if name in _ORDER else len(_ORDER), name))
    powers = [(name, float(str(dimensions[name]))) for name in known]
    above = " * ".join(f"{name} ** {power:g}" if power != 1.0 else name for name, power in powers if power > 0.0)
    below = "".join(
        f" / {name} ** {-power:g}" if power != -1.0 else f" / {name}" for name, power in powers if power < 0.0
    )
    return (above or "1") + below if powers else "dimensionless"


def base_units(unit: str) -> frozenset[str]:
    """Names of the units that `unit` is made of, without prefixes, e.g. {degree, second} for `mdeg/s`."""
    dimensionality(unit)
    registry = _registry()
    return frozenset(
        name
        for full, _ in registry.Quantity(1.0, _unit(unit)).unit_items()
        for _, name, _ in registry.parse_unit_name(full)
    )


def affine(unit: str, to: str) -> tuple[float, float]:
    """Factor and offset that turn a number in `unit` into a number in `to`."""
    registry = _registry()
    zero = registry.Quantity(0.0, _unit(unit)).to(_unit(to)).magnitude
    one = registry.Quantity(1.0, _unit(unit)).to(_unit(to)).magnitude
    return float(one - zero), float(zero)
