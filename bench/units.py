"""Units: SI inside, pint at the edges only (files and command line)."""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass
from functools import cache

from bench.arrays import Array
from bench.errors import InputError
from bench.names import short
from bench.unit_grammar import LONGEST
from bench.unit_text import EFFECTIVE, UnitError, scale_of
from bench.usual_units import USUAL_UNITS

_NUMBER = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_VALUE = re.compile(rf"([+-]?{_NUMBER})\s*(.*)")
_TOLERANCE = re.compile(rf"([+-]?{_NUMBER})\s*(?:\+/-|±)\s*({_NUMBER})\s*(.*)")
#: Characters of a value: as many digits as anyone writes, and a unit.
_LONGEST = 64 + LONGEST


@dataclass(frozen=True)
class Quantity:
    """A physical quantity: what it is called, its SI unit and what values physics allows.

    Attributes:
        name: the field's term, e.g. `moment_of_inertia`.
        symbol: its letter in equations, e.g. `J`.
        unit: SI unit as pint reads it, e.g. `kg*m**2`.
        lower, upper: closed bounds in that unit.
        angle: whether it stays an angle on a linear axis, where other angles become lengths.
        linear_unit: SI unit on a linear axis, where it is not the rotary one with metres and newtons in it.
        null: value at which what it belongs to is exactly absent, if one says so.
        preset: value that it has where none is given, if it need not be.
        instant: whether it is a time of the recording, whose zero means nothing.
    """

    name: str
    symbol: str
    unit: str
    lower: float = -math.inf
    upper: float = math.inf
    angle: bool = False
    linear_unit: str | None = None
    null: float | None = None
    preset: float | None = None
    instant: bool = False


@cache
def dimensionality(unit: str) -> str:
    """Dimension of a unit, e.g. `[length] / [time]`; ValueError if `unit` is no unit.

    pint counts angles as dimensionless; the bench follows it, so rad/s and 1/s are one dimension.
    """
    if unit in USUAL_UNITS:
        return USUAL_UNITS[unit].dimensionality
    from bench import unit_registry

    return unit_registry.dimensionality(unit)


@cache
def base_units(unit: str) -> frozenset[str]:
    """Names of the units that `unit` is made of, without prefixes, e.g. {degree, second} for `mdeg/s`."""
    if unit in USUAL_UNITS:
        return frozenset(USUAL_UNITS[unit].base_units.split())
    from bench import unit_registry

    return unit_registry.base_units(unit)


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
    from bench import unit_registry

    return unit_registry.affine(unit, to)


def convert(values: Array, unit: str, to: str) -> Array:
    """Values of any shape from `unit` to `to` (same dimension); the same array when nothing changes."""
    factor, offset = affine(unit, to)
    if offset == 0.0:
        return values if factor == 1.0 else values * factor
    return values * factor + offset


def parse(text: object, unit: str, where: object) -> float:
    """A value such as `"22.4 kg*cm**2"` in `unit`.

    Raises:
        InputError: no finite number with a unit, or of another dimension; names `where`.
    """
    allowed = f'allowed: a number with a unit of the dimension of {unit}, e.g. "1.5 {unit}"'
    match = _VALUE.fullmatch(text.strip()) if isinstance(text, str) and len(text) <= _LONGEST else None
    if match is None:
        raise InputError(where, f"found {short(repr(text))}", allowed)
    number, given = match.groups()
    if EFFECTIVE.search(given):
        told = 'say current = "effective" in the same table and write A'
        raise InputError(where, f"found {text!r}, an effective current", f"allowed: A; {told}")
    try:
        scale = scale_of(given, (unit,))
    except UnitError as error:
        raise InputError(where, f"found {text!r}", error.allowed if "may mean" in error.found else allowed) from error
    value = float(number) * scale.factor + scale.offset
    if not math.isfinite(value):
        raise InputError(where, f"found {text!r}", allowed)
    return value


def parse_with_tolerance(text: object, unit: str, where: object) -> tuple[float, float]:
    """A value such as `"0.78 +/- 0.04 N*m/A"` and its tolerance, in `unit`; 0 where none is stated.

    Raises:
        InputError: as `parse`.
    """
    match = _TOLERANCE.fullmatch(text.strip()) if isinstance(text, str) and len(text) <= _LONGEST else None
    if match is None:
        return parse(text, unit, where), 0.0
    number, tolerance, given = match.groups()
    value, end = (parse(f"{one!r} {given}", unit, where) for one in (float(number), float(number) + float(tolerance)))
    return value, abs(end - value)


def nearest(name: str, names: list[str]) -> str:
    """`, did you mean ...?` for a mistyped name, or nothing when no known name is near."""
    match = difflib.get_close_matches(name, names, n=1)
    return f", did you mean '{match[0]}'?" if match else ""
