"""pint's registry, by which every unit is read; `bench.units` asks it for what is not among the usual ones."""

from __future__ import annotations

from functools import cache
from tokenize import TokenError

import pint

from bench.unit_grammar import require_unit

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


@cache
def _unit(unit: str) -> pint.Unit:
    require_unit(unit)
    return _registry().Unit(unit)


def dimensionality(unit: str) -> str:
    """Dimension of a unit, e.g. `[length] / [time]`; ValueError if `unit` is no unit."""
    try:
        return str(_unit(unit).dimensionality)
    except _NO_UNIT as error:
        raise ValueError(f"'{unit}' is not a unit") from error


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
