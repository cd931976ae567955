"""Dimension of a unit and conversion between units: SI and what is usual by a table, all other names by pint.

Units are read as people and recorders write them: `1/min`, `U/min`, `°/s`, `Nm`, `oz-in`, `Arms`, `0.229 rpm`,
`turn/4096/s`. An ambiguous one is refused and both meanings are named: a speed in `1/s` or `Hz` may be radians or
revolutions; what a count is worth, only the user can state.

Importing pint and building its registry costs 0.2 s of CPU, a quarter of the run time of `bench identify`. It is used
for single names only, so that no text of a file is an expression that it evaluates.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from tokenize import TokenError
from typing import TYPE_CHECKING, NamedTuple

from bench.arrays import Array
from bench.units.grammar import UnitError, UnitProduct, allowed, parse_unit

if TYPE_CHECKING:
    import pint

#: Order in which dimensions are written; pint's own depends on how the unit was composed.
_ORDER = ("[mass]", "[length]", "[time]", "[current]", "[temperature]", "[substance]", "[luminosity]")


class NamedUnit(NamedTuple):
    """The meaning of one name: `SI = number*factor + offset`.

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
#: Base units of a turning speed in pint, and those that it calls dimensionless and that are no angle.
_KINDS = {
    "angle": "radian degree turn rpm grade arcminute arcsecond milliarcsecond angular_mil",
    "share": "percent permille ppm",
    "count": "bit byte particle number count decibel neper",
}
#: What pint raises on names that are no unit, in addition to errors of its own.
_NO_UNIT = (AttributeError, LookupError, TypeError, ValueError, AssertionError, ArithmeticError)
#: A mass in place of the force it weighs, as in kg*cm for N*m: its powers. ISO 80000-3: g_n.
_MASS = ((1,), (1, 0, 0))
_STANDARD_GRAVITY = 9.80665
#: What may also be written over a speed or an acceleration, without an angle in SI: V/(rad/s), N*m/(rad/s**2), W*s/rad.
_PER_TURN = ("N*m", "kg*m**2", "N*m/A", "N*m/V")


@cache
def named_unit(name: str) -> NamedUnit:
    """The meaning of a name; ValueError if it is no unit."""
    if name in _USUAL:
        return _USUAL[name]
    if name[:1] in _PREFIXES and name[1:] in _PREFIXED:
        whole = _USUAL[name[1:]]
        return whole._replace(factor=_PREFIXES[name[0]] * whole.factor)
    return _by_pint(name)


@cache
def _registry() -> pint.UnitRegistry:
    import pint

    registry = pint.UnitRegistry(cache_folder=None)
    registry.define("rpm = revolution / minute")
    return registry


def _by_pint(name: str) -> NamedUnit:
    """As `named_unit`; the factor of a logarithm, such as dB, is nan."""
    from pint.errors import PintError

    registry = _registry()
    try:
        unit = registry.Unit(name)
        zero, one, two = (float(registry.Quantity(value, unit).to_base_units().magnitude) for value in (0.0, 1.0, 2.0))
        powers = {dimension: float(str(power)) for dimension, power in unit.dimensionality.items()}
        ((full, _),) = registry.Quantity(1.0, unit).unit_items()
        base = registry.parse_unit_name(full)[0][1]
    except (PintError, TokenError, *_NO_UNIT) as error:
        raise ValueError(f"'{name}' is not a unit") from error
    known = tuple(powers.pop(dimension, 0.0) for dimension in _ORDER)
    if powers:
        raise ValueError(f"'{name}' measures {', '.join(powers)}")
    kind = next((kind for kind, names in _KINDS.items() if base in names.split()), "")
    linear = math.isclose(two - one, one - zero, rel_tol=1e-9)
    return NamedUnit(one - zero if linear else math.nan, known, kind, zero if linear else 0.0)


def powers_of(unit: UnitProduct) -> tuple[float, ...]:
    """Exponents of the dimensions of `_ORDER`; ValueError if a name of it is no unit.

    pint counts angles as dimensionless; the bench follows it, so rad/s and 1/s are one dimension.
    """
    total = [0.0] * len(_ORDER)
    for name, exponent in unit.powers.items():
        for place, power in enumerate(named_unit(name).powers):
            total[place] += power * exponent
    return tuple(total)


def to_si(unit: UnitProduct) -> tuple[float, float]:
    """Factor and offset that turn a number in a unit into one in SI; a temperature's zero counts if it is the only
    unit."""
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
    raised = [(name if abs(power) == 1.0 else f"{name} ** {abs(power):g}", power) for name, power in powers]
    above = " * ".join(name for name, power in raised if power > 0.0)
    below = "".join(f" / {name}" for name, power in raised if power < 0.0)
    return (above or "1") + below if above or below else "dimensionless"


def same_dimension(unit: str, other: str) -> bool:
    """Whether two units measure the same kind of quantity."""
    return powers_of(_parsed(unit)) == powers_of(_parsed(other))


def convert(values: Array, unit: str, to: str) -> Array:
    """Values of any shape from `unit` to `to`; the same array when nothing changes.

    Raises:
        ValueError: they differ in dimension, or one is no unit.
    """
    if not same_dimension(unit, to):
        raise ValueError(f"'{unit}' is not a unit of the dimension of {to}")
    (factor, offset), (wanted, zero) = to_si(_parsed(unit)), to_si(_parsed(to))
    factor, offset = factor / wanted, (offset - zero) / wanted
    if offset == 0.0:
        return values if factor == 1.0 else values * factor
    return values * factor + offset


@dataclass(frozen=True)
class UnitScale:
    """How numbers in a unit become SI: `value = number*factor + offset`, in `unit`; `note`: what was assumed."""

    unit: str
    factor: float
    offset: float = 0.0
    note: str = ""


@cache
def scale_of(text: str, wanted: tuple[str, ...]) -> UnitScale:
    """How numbers under a unit text become SI.

    Args:
        text: as written.
        wanted: SI units it may stand for, best first, e.g. ("rad/s", "m/s"); `dimensionless` admits a share such as %.

    Raises:
        UnitError: no unit, none of those wanted, or one of two meanings.
    """
    unit = parse_unit(text, wanted)
    try:
        known = {name: named_unit(name) for name in unit.powers}
    except ValueError as error:
        raise UnitError(f"found '{text}', which is not a unit", allowed(wanted)) from error
    kinds = {one.kind for one in known.values()}
    angle = sum(power for name, power in unit.powers.items() if known[name].kind == "angle")
    for si in wanted:
        weight, turns = _weight(unit, si), parse_unit(si).powers.get("rad", 0.0)
        if weight is None or (turns and kinds & {"share", "count"}) or (angle and si == "dimensionless"):
            continue
        factor, offset = to_si(unit)
        if len(unit.powers) + (unit.factor != 1.0) > 1 and any(one.offset for one in known.values()):
            raise UnitError(f"found '{unit.factor:g} {unit}'", f"allowed: {unit} without a factor, or {si}")
        if not math.isfinite(factor):
            break  # a logarithm, which has no factor
        if si in _PER_TURN and (angle or {"min", "Hz"} & set(unit.powers)):
            if angle and not any(_measures_time(one) for one in known.values()):
                continue  # a stiffness
            turns = -1.0
        if turns and not angle:
            if unit.powers.get("min", 0.0) * turns >= 0.0:
                other = si.replace("rad", "rev")
                which = (si, other) if other != si else (f"{text}/rad", f"{text}/rev")
                advice = f"allowed: '{which[0]}' where it is radians, '{which[1]}' where it is revolutions"
                raise UnitError(f"found '{text}', which may mean {' or '.join(which)}", advice)
            factor *= (2.0 * math.pi) ** turns  # per minute means revolutions
        elif turns != angle and turns:
            continue
        return UnitScale(si, factor * weight, offset, unit.note)
    raise UnitError(f"found unit '{text}'", allowed(wanted))


def _weight(unit: UnitProduct, si: str) -> float | None:
    """1 where a unit has the dimension of `si`; g where its mass means the force that it weighs; else None."""
    powers, aim = powers_of(unit), powers_of(parse_unit(si))
    if powers == aim:
        return 1.0
    masses = [name for name, power in unit.powers.items() if power == 1 and named_unit(name).powers[:3] in _MASS]
    weighs = masses and (si[0] == "N" or si == "kg*m**2") and powers == (aim[0], aim[1] - 1, aim[2] + 2, *aim[3:])
    return _STANDARD_GRAVITY if weighs else None


def _measures_time(unit: NamedUnit) -> bool:
    return any(unit.powers) and not any(unit.powers[:2]) and not any(unit.powers[3:])


@cache
def scale_or_none(text: str, wanted: tuple[str, ...]) -> UnitScale | None:
    """As `scale_of`; None where that raises."""
    try:
        return scale_of(text, wanted)
    except UnitError:
        return None


@cache
def is_unit(text: str) -> bool:
    """Whether a text is a unit, ambiguous ones included."""
    try:
        unit = parse_unit(text)
        powers_of(unit)
    except UnitError as error:
        return not error.found.endswith("not a unit")
    except ValueError:
        return False
    return bool(unit.powers)
