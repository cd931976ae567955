"""Values with a unit as rig files and the command line give them, e.g. `22.4 kg*cm**2` or `0.78 +/- 0.04 N*m/A`."""

from __future__ import annotations

import math
import re

from bench.errors import InputError
from bench.names import short
from bench.units.grammar import EFFECTIVE, LONGEST
from bench.units.text import UnitError, scale_of

_NUMBER = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_VALUE = re.compile(rf"([+-]?{_NUMBER})\s*(.*)")
_TOLERANCE = re.compile(rf"([+-]?{_NUMBER})\s*(?:\+/-|±)\s*({_NUMBER})\s*(.*)")
#: Characters of a value: as many digits as anyone writes, and a unit.
_LONGEST = 64 + LONGEST


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
        advice = 'say current = "effective" in the same table and write A'
        raise InputError(where, f"found {text!r}, an effective current", f"allowed: A; {advice}")
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
