"""A physical quantity: its name, SI unit and bounds; and values as rig files and the command line give them.

A value has a unit, e.g. `22.4 kg*cm**2` or `0.78 +/- 0.04 N*m/A`.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from bench.errors import InputError
from bench.names import short
from bench.units.conversion import scale_of
from bench.units.grammar import EFFECTIVE, LONGEST, UnitError

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
        null: value at which what it belongs to is exactly absent, if it has one.
        preset: value that it has where none is given, if it need not be.
        instant: whether it is a time of the recording, whose zero means nothing.
        minor: whether what it belongs to is known without it, as with how an effect divides between dry and viscous, or
            how hard the contact is at the ends of a gap.
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
    minor: bool = False

    @property
    def positive(self) -> bool:
        """Whether there is none of it that is 0, so that it is known up to a factor: a stiffness, a time constant."""
        return self.lower == 0.0 and self.null is None and self.preset is None and not self.instant


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
        advice = 'set current = "effective" in the same table and write A'
        raise InputError(where, f"found {text!r}, an effective current", f"allowed: A; {advice}")
    try:
        scale = scale_of(given, (unit,))
    except UnitError as error:
        raise InputError(where, f"found {text!r}", error.allowed if "may mean" in error.found else allowed) from error
    value = float(number) * scale.factor + scale.offset
    if scale.note or not math.isfinite(value):
        raise InputError(
            where, f"found {text!r}", f"{allowed}; a leading m means thousandths" if scale.note else allowed
        )
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
