"""Dimension of a unit, and conversion between units; pint is imported only for units outside the usual table."""

from __future__ import annotations

from functools import cache

from bench.arrays import Array
from bench.units.usual import USUAL_UNITS


@cache
def dimensionality(unit: str) -> str:
    """Dimension of a unit, e.g. `[length] / [time]`; ValueError if `unit` is no unit.

    pint counts angles as dimensionless; the bench follows it, so rad/s and 1/s are one dimension.
    """
    if unit in USUAL_UNITS:
        return USUAL_UNITS[unit].dimensionality
    from bench.units import registry  # pint: 0.2 s

    return registry.dimensionality(unit)


@cache
def base_units(unit: str) -> frozenset[str]:
    """Names of the units that `unit` is made of, without prefixes, e.g. {degree, second} for `mdeg/s`."""
    if unit in USUAL_UNITS:
        return frozenset(USUAL_UNITS[unit].base_units.split())
    from bench.units import registry  # pint: 0.2 s

    return registry.base_units(unit)


def same_dimension(unit: str, other: str) -> bool:
    """Whether two units measure the same kind of quantity."""
    return dimensionality(unit) == dimensionality(other)


@cache
def affine(unit: str, to: str) -> tuple[float, float]:
    """Factor and offset that turn a number in `unit` into a number in `to`."""
    if unit in USUAL_UNITS and to in USUAL_UNITS:
        given, wanted = USUAL_UNITS[unit], USUAL_UNITS[to]
        if wanted.factor == 1.0 and given.dimensionality == wanted.dimensionality:
            return given.factor, 0.0
    from bench.units import registry  # pint: 0.2 s

    return registry.affine(unit, to)


def convert(values: Array, unit: str, to: str) -> Array:
    """Values of any shape from `unit` to `to` (same dimension); the same array when nothing changes."""
    factor, offset = affine(unit, to)
    if offset == 0.0:
        return values if factor == 1.0 else values * factor
    return values * factor + offset
