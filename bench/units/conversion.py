"""Dimension of a unit and conversion between units: SI and what is usual by a table, all other names by pint.

Importing pint and building its registry costs 0.2 s of CPU, a quarter of the run time of `bench identify`. It is asked
for single names only, so that no text of a file is an expression that it evaluates.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

from bench.arrays import Array
from bench.units.grammar import UnitProduct, parse_unit

#: Order in which dimensions are written; pint's own depends on how the unit was composed.
_ORDER = ("[mass]", "[length]", "[time]", "[current]", "[temperature]", "[substance]", "[luminosity]")


class NamedUnit(NamedTuple):
    """What one name stands for: `SI = number*factor + offset`.

    Attributes:
        factor, offset: to the units of `_ORDER` in SI; radian of an angle.
        powers: exponents of the first dimensions of `_ORDER`, 0 where one is missing.
        kind: `angle`, `share` or `count` of what has no dimension or turns; else nothing.
    """

    factor: float
    powers: tuple[float, ...]
    kind: str = ""
    offset: float = 0.0


_USUAL = {
    "g": NamedUnit(1e-3, (1,)),
    "m": NamedUnit(1.0, (0, 1)),
    "s": NamedUnit(1.0, (0, 0, 1)),
    "min": NamedUnit(60.0, (0, 0, 1)),
    "hour": NamedUnit(3600.0, (0, 0, 1)),
    "Hz": NamedUnit(1.0, (0, 0, -1)),
    "A": NamedUnit(1.0, (0, 0, 0, 1)),
    "K": NamedUnit(1.0, (0, 0, 0, 0, 1)),
    "degC": NamedUnit(1.0, (0, 0, 0, 0, 1), offset=273.15),
    "N": NamedUnit(1.0, (1, 1, -2)),
    "W": NamedUnit(1.0, (1, 2, -3)),
    "V": NamedUnit(1.0, (1, 2, -3, -1)),
    "ohm": NamedUnit(1.0, (1, 2, -3, -2)),
    "H": NamedUnit(1.0, (1, 2, -2, -2)),
    "rad": NamedUnit(1.0, (), "angle"),
    "deg": NamedUnit(math.pi / 180.0, (), "angle"),
    "turn": NamedUnit(2.0 * math.pi, (), "angle"),
    "rpm": NamedUnit(math.pi / 30.0, (0, 0, -1), "angle"),
    "percent": NamedUnit(1e-2, (), "share"),
    "permille": NamedUnit(1e-3, (), "share"),
    "dimensionless": NamedUnit(1.0, ()),
}
_PREFIXES = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "d": 1e-1, "k": 1e3}
_PREFIXED = ("g", "m", "s", "A", "K", "N", "W", "V", "ohm", "H", "Hz", "rad", "deg", "rpm")
#: Base units by which pint says that a speed turns, and those that it calls dimensionless and that are no angle.
_KINDS = {
    "angle": "radian degree turn rpm grade arcminute arcsecond milliarcsecond angular_mil",
    "share": "percent permille ppm",
    "count": "bit byte particle number count decibel neper",
}


@cache
def named_unit(name: str) -> NamedUnit:
    """What a name stands for; ValueError if it is no unit."""
    if name in _USUAL:
        return _USUAL[name]
    if name[:1] in _PREFIXES and name[1:] in _PREFIXED:
        whole = _USUAL[name[1:]]
        return whole._replace(factor=_PREFIXES[name[0]] * whole.factor)
    from bench.units.registry import by_pint  # 0.2 s

    factor, offset, powers, base = by_pint(name)
    known = tuple(powers.pop(dimension, 0.0) for dimension in _ORDER)
    if powers:
        raise ValueError(f"'{name}' measures {', '.join(powers)}")
    return NamedUnit(factor, known, next((kind for kind, names in _KINDS.items() if base in names.split()), ""), offset)


def powers_of(unit: UnitProduct) -> tuple[float, ...]:
    """Exponents of the dimensions of `_ORDER`; ValueError if a name of it is no unit.

    pint counts angles as dimensionless; the bench follows it, so rad/s and 1/s are one dimension.
    """
    total = [0.0] * len(_ORDER)
    for name, exponent in unit.powers.items():
        for place, power in enumerate(named_unit(name).powers):
            total[place] += power * exponent
    return tuple(total)


def kinds_of(unit: UnitProduct) -> frozenset[str]:
    """Kinds of the names that a unit is made of."""
    return frozenset(named_unit(name).kind for name in unit.powers)


def to_si(unit: UnitProduct) -> tuple[float, float]:
    """Factor and offset that turn a number in a unit into one in SI; a temperature's zero counts if it stands alone."""
    if len(unit.powers) == 1 and unit.factor == 1.0:
        ((name, exponent),) = unit.powers.items()
        if exponent == 1:
            return named_unit(name).factor, named_unit(name).offset
    return unit.factor * math.prod(named_unit(name).factor ** power for name, power in unit.powers.items()), 0.0


@cache
def _parsed(unit: str) -> UnitProduct:
    try:
        parsed = parse_unit(unit)
        powers_of(parsed)
    except ValueError as error:  # a UnitError among them
        raise ValueError(f"'{unit}' is not a unit") from error
    return parsed


@cache
def dimensionality(unit: str) -> str:
    """Dimension of a unit, e.g. `[length] / [time]`; ValueError if `unit` is no unit."""
    powers = list(zip(_ORDER, powers_of(_parsed(unit)), strict=True))
    above = " * ".join(f"{name} ** {power:g}" if power != 1.0 else name for name, power in powers if power > 0.0)
    below = "".join(
        f" / {name} ** {-power:g}" if power != -1.0 else f" / {name}" for name, power in powers if power < 0.0
    )
    return (above or "1") + below if above or below else "dimensionless"


def same_dimension(unit: str, other: str) -> bool:
    """Whether two units measure the same kind of quantity."""
    return powers_of(_parsed(unit)) == powers_of(_parsed(other))


@cache
def affine(unit: str, to: str) -> tuple[float, float]:
    """Factor and offset that turn a number in `unit` into a number in `to`; ValueError if they differ in dimension."""
    if not same_dimension(unit, to):
        raise ValueError(f"'{unit}' is not a unit of the dimension of {to}")
    (factor, offset), (wanted, zero) = to_si(_parsed(unit)), to_si(_parsed(to))
    return factor / wanted, (offset - zero) / wanted


def convert(values: Array, unit: str, to: str) -> Array:
    """Values of any shape from `unit` to `to` (same dimension); the same array when nothing changes."""
    factor, offset = affine(unit, to)
    if offset == 0.0:
        return values if factor == 1.0 else values * factor
    return values * factor + offset
