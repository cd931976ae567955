"""Limits on a unit's text before pint sees it: length, depth of brackets, size of exponents.

pint evaluates any arithmetic in a text: `m**9**9**9` never ends, each bracket is a recursion, and a name of thousands
of letters is compared with every prefix and suffix.
"""

from __future__ import annotations

import math
import re

#: Characters of a unit and depth of its brackets; `kg*m**2/s**3/A**2` has 17 and none.
LONGEST, DEEPEST = 120, 6
#: The largest exponent, and the largest product of all; that of `kg*m**2/s**3/A**2` is 12.
STEEPEST, STEEPEST_OF_ALL = 12.0, 1000.0
_EXPONENT = re.compile(
    r"(?:\*\*|\^)\s*(?P<open>\(\s*)?[+-]?\s*(?P<plain>\d{1,3}(?:\.\d{0,6})?|\.\d{1,6})(?![\w.])\s*"
    r"(?(open)(?:/\s*\d{1,3}\s*)?\))|(?P<raised>[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]{1,3})"
)
_DIGITS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789", "⁺⁻")
_RAISED = "\0"


def require_unit(text: str) -> None:
    """Raise ValueError with the reason if a text exceeds a limit."""
    if len(text) > LONGEST:
        raise ValueError(f"a unit of {len(text)} characters; allowed: {LONGEST}")
    if not text.isprintable():
        raise ValueError("a unit with control characters")
    depth = deepest = 0
    for character in text:
        depth += (character == "(") - (character == ")")
        deepest = max(deepest, depth)
    if deepest > DEEPEST:
        raise ValueError(f"{deepest} brackets in one another; allowed: {DEEPEST}")
    exponents = [
        float(match["plain"] or (match["raised"] or "").translate(_DIGITS)) for match in _EXPONENT.finditer(text)
    ]
    rest = _EXPONENT.sub(_RAISED, text)
    if "**" in rest or "^" in rest or re.search(rf"{_RAISED}\s*{_RAISED}", rest):
        raise ValueError("a power of something else than a number, or of a power")
    if max(exponents, default=0.0) > STEEPEST or math.prod(max(e, 1.0) for e in exponents) > STEEPEST_OF_ALL:
        raise ValueError(f"exponents beyond {STEEPEST:g}")
