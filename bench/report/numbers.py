"""Numbers and units as a person reads them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from bench.names import LEAST_SHARE, percent
from bench.parameter import Parameter

#: Keeps a value, its interval and its unit on one line.
SPACE = "\N{NO-BREAK SPACE}"
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
#: Values outside of these are written with a power of ten.
SMALL, LARGE = 1e-2, 1e5
#: The same of half an interval that contains zero.
SMALL_HALF = 1e-4
#: Digits behind the point, where an interval is next to nothing.
MOST_DECIMALS = 9


def unit_text(unit: str) -> str:
    """A unit as it is printed: `kg·m²` of `kg*m**2`; empty where there is none."""
    unit = re.sub(r"^dimensionless\*?", "", unit)  # of a torque that is a share of the rated one
    raised = re.sub(r"\*\*(-?\d+)", lambda found: found[1].translate(_RAISED), unit)
    return raised.replace("*", "·").replace("ohm", "Ω")


def number(value: float, unit: str = "", digits: int = 4, zeros: bool = False) -> str:
    """A value with its unit; `zeros`: whether it keeps those at its end, which then are digits that are known."""
    if not math.isfinite(value):
        return "not known"
    text = f"{value:#.{digits}g}".replace(".e", "e").rstrip(".") if zeros else f"{value:.{digits}g}"
    if "e" in text:
        mantissa, power = text.split("e")
        text = f"{mantissa}·10{str(int(power)).translate(_RAISED)}"
    text = text.replace("-", "−")
    return f"{text}{SPACE}{unit_text(unit)}".strip()


def interval(found: Parameter, unit: bool = True) -> str:
    """A parameter with half of its interval of 95 %, to the second digit of that, or the ends of one of a factor."""
    shown = unit_text(found.unit) if unit else ""
    if found.lopsided:
        low, high = (number(float(f"{bound:.{found.digits}g}")) for bound in found.ci95)
        return f"{number(found.value, digits=3)}{SPACE}({low}{SPACE}to{SPACE}{high}){SPACE}{shown}".strip()
    half = found.half_width
    if not math.isfinite(half) or half <= 0.0:
        return f"{number(found.value, digits=5)}{SPACE}{shown}".strip()
    size = abs(found.value)
    small, size = (SMALL, size) if size > half else (SMALL_HALF, half)
    power = 3 * math.floor(math.log10(size) / 3) if not small <= size < LARGE else 0
    scale = 10.0**power
    decimals = min(max(0, 1 - math.floor(math.log10(half / scale))), MOST_DECIMALS)
    value = f"{found.value / scale:z.{decimals}f}".replace("-", "−")
    text = f"{value}{SPACE}±{SPACE}{half / scale:.{decimals}f}"
    if power:
        text = f"({text})·10{str(power).translate(_RAISED)}"
    return f"{text}{SPACE}{shown}".strip()


def brief(found: Parameter) -> str:
    """A parameter to three digits, with half of its interval of 95 % in per cent where that is more informative."""
    size, half = abs(found.value), found.half_width
    if found.lopsided or not 0.0 < half < size < math.inf:
        return interval(found)
    relative = number(100.0 * half / size, digits=2)
    return f"{number(found.value, found.unit, 3, zeros=True)}{SPACE}±{SPACE}{relative}{SPACE}%"


def share(value: float) -> str:
    """A share in per cent."""
    return percent(value).replace(" %", f"{SPACE}%")


def chance(value: float) -> str:
    """A probability in per cent, which is never quite 0 or 1."""
    if not LEAST_SHARE < value < 1.0 - LEAST_SHARE:
        return f"< {100.0 * LEAST_SHARE:g}{SPACE}%" if value < 0.5 else f"> {100.0 - 100.0 * LEAST_SHARE:g}{SPACE}%"
    return f"{100.0 * value:.2g}{SPACE}%" if value < 0.99 else f"{100.0 * value:.1f}{SPACE}%"


def sentence(text: str) -> str:
    """A text with a capital at its beginning."""
    return text[:1].upper() + text[1:]


def listed(texts: Iterable[str]) -> str:
    """Texts in a row: `a, b and c`; empty of none."""
    found = list(texts)
    return " and ".join(filter(None, (", ".join(found[:-1]), *found[-1:])))


def effort_word(unit: str) -> str:
    """What an effort in a unit is: torque, force, current or voltage."""
    return {"N*m": "torque", "N": "force", "A": "current", "V": "voltage"}.get(unit, "effort")


def coordinate_word(coordinate: str, unit: str) -> str:
    """What a coordinate of the gap is called on an axis; the current is the torque where no current was recorded."""
    labels = {"current": effort_word(unit), "reversal": "time since reversal"}
    return labels.get(coordinate, coordinate)
