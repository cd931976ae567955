"""Units as people and recorders write them: `1/min`, `U/min`, `°/s`, `Nm`, `oz-in`, `Arms`, `0.229 rpm`, `turn/4096/s`.

An ambiguous unit is refused and both meanings are named: a speed in `1/s` or `Hz` may be radians or revolutions; what a
count is worth, only the user knows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

from bench.units.conversion import kinds_of, named_unit, powers_of, to_si
from bench.units.grammar import UnitError, UnitProduct, allowed, parse_unit

#: Efforts and accelerations told by the mass that weighs so much: N*m in kg*cm, m/s**2 in g. ISO 80000-3: g_n.
_MASS = {"N*m": "kg*m", "N": "kg"}
_STANDARD_GRAVITY = 9.80665


@dataclass(frozen=True)
class UnitScale:
    """How numbers in a unit become SI: `value = number*factor + offset`, in `unit`."""

    unit: str
    factor: float
    offset: float = 0.0


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
        powers, kinds = powers_of(unit), kinds_of(unit)
    except ValueError as error:
        raise UnitError(f"found '{text}', which is not a unit", allowed(wanted)) from error
    for si in wanted:
        turning = "rad" in si and si.count("/") <= 1
        if powers_of(parse_unit(si)) == powers and not (turning and kinds & {"share", "count"}):
            factor, offset = to_si(unit)
            if len(unit.powers) + (unit.factor != 1.0) > 1 and any(named_unit(name).offset for name in unit.powers):
                raise UnitError(f"found '{unit.factor:g} {unit}'", f"allowed: {unit} without a factor, or {si}")
            if not math.isfinite(factor):
                break  # a logarithm, which has no factor
            if turning and "angle" not in kinds:
                factor *= _turning(text, si, unit)
            return UnitScale(si, factor, offset)
        if si in _MASS and powers_of(parse_unit(_MASS[si])) == powers:
            return UnitScale(si, to_si(unit)[0] * _STANDARD_GRAVITY)
    if text != text.lower():
        try:
            return scale_of(text.lower(), wanted)
        except UnitError:
            pass
    raise UnitError(f"found unit '{text}'", allowed(wanted))


def _turning(text: str, si: str, unit: UnitProduct) -> float:
    """Radians of a unit without an angle: per minute it means revolutions, otherwise it is ambiguous."""
    if "min" in unit.powers:
        return 2.0 * math.pi
    turns = si.replace("rad", "rev")
    raise UnitError(
        f"found '{text}', which may mean {si} or {turns}",
        f"allowed: '{si}' where it is radians, '{turns}' where it is revolutions",
    )


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


def spelled_for_pint(text: str) -> str:
    """A unit in pint's spelling, e.g. `N*m` for `Nm`; unchanged if it is no unit or has a factor."""
    try:
        unit = parse_unit(text)
    except UnitError:
        return text
    return str(unit) if unit.factor == 1.0 else text
