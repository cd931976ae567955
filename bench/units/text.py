"""Units as people and recorders write them: `1/min`, `U/min`, `°/s`, `Nm`, `oz-in`, `Arms`, `0.229 rpm`, `turn/4096/s`.

A text is a product of numbers and names, each with an integer exponent, read from left to right; `*`, `/`, a blank, or
a hyphen or point between names separates them. Numbers become a factor, names those that pint knows. An ambiguous unit
is refused and both meanings are named: a speed in `1/s` or `Hz` may be radians or revolutions; what a count is worth,
only the user knows.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cache

from bench.units.conversion import affine, base_units, dimensionality
from bench.units.names import ATOMS, COUNTS, ELECTRICAL, TRANSLATED, WHOLE

#: No recorder writes a longer one, nor higher powers.
_LONGEST, _HIGHEST, _LARGEST_POWER = 80, 9, 64

_TOKEN = re.compile(
    r"\s*(?:"
    r"(?P<root>sqrt\s*\(\s*(?P<radicand>\d+(?:\.\d+)?)\s*\))"
    r"|(?P<number>\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)(?:(?:\^|\*\*)\(?(?P<power>[+-]?\d+)\)?)?"
    r"|(?P<name>[^\W\d]+|%)(?:(?:\^|\*\*)?(?:\((?P<inside>[+-]?\d)\)|(?P<exponent>[+-]?\d)(?![\d.,])))?"
    r"|(?P<operator>[*/()])"
    r"|(?P<joint>(?<=[^\W\d])[-.](?=[^\W\d]))"
    r")"
)
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_RAISED = re.compile("[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+")
#: An effective current, however it is written.
EFFECTIVE = re.compile(r"(?<![^\W_])([munk]?A|[mk]?Amps?)[\s_.-]*\(?(rms|eff|effektiv|effective)\)?(?![^\W_])", re.I)
_PEAK = re.compile(r"(?<![^\W_])([munk]?A)[\s_.-]*\(?(0-pk|pk|peak|p)\)?(?![^\W_])", re.I)
_NEWTON_METRES = re.compile(r"(da|[unmcdkM]?)N([cmk]?m)")
_PEAK_TO_PEAK = re.compile(r"(?<![^\W_])([munk]?A)[\s_.-]*\(?(pp|pk-pk|p-p|pkpk)\)?(?![^\W_])", re.I)
_COMMENT = re.compile(r"(?<=\S)\s*\((?!.*(?:eff|rms|peak|pk|el))[^()\d]{3,}\)\s*$", re.I)
#: Base units of angles, by which a speed says that it turns.
_ANGLES = frozenset(
    ("radian", "degree", "turn", "rpm", "grade", "arcminute", "arcsecond", "milliarcsecond", "angular_mil")
)
#: Base units that pint calls dimensionless and that are no angle.
_NUMBERS = frozenset(("percent", "permille", "ppm", "bit", "byte", "particle", "number", "count", "decibel", "neper"))
#: Efforts and accelerations told by the mass that weighs so much: N*m in kg*cm, m/s**2 in g. ISO 80000-3: g_n.
_MASS = {"N*m": "kg*m", "N": "kg"}
_STANDARD_GRAVITY = 9.80665


class UnitError(ValueError):
    """A text that is no unit, or not plainly one: `found` says what it is, `allowed` what would be."""

    def __init__(self, found: str, allowed: str) -> None:
        self.found, self.allowed = found, allowed
        super().__init__(f"{found}; {allowed}")


@dataclass(frozen=True)
class Scale:
    """How numbers in a unit become SI: `value = number*factor + offset`, in `unit`."""

    unit: str
    factor: float
    offset: float = 0.0


@cache
def scale_of(text: str, wanted: tuple[str, ...]) -> Scale:
    """How numbers under a unit text become SI.

    Args:
        text: as written.
        wanted: SI units it may stand for, best first, e.g. ("rad/s", "m/s"); `dimensionless` admits a share such as %.

    Raises:
        UnitError: no unit, none of those wanted, or one of two meanings.
    """
    factor, names = _parsed(text, wanted)
    unit = _spelled(names)
    try:
        dimension, base = dimensionality(unit), _base(names)
    except ValueError as error:
        raise UnitError(f"found '{text}', which is not a unit", _allowed(wanted)) from error
    for si in wanted:
        turning = "rad" in si and si.count("/") <= 1
        if dimensionality(si) == dimension and not (turning and base & _NUMBERS):
            if not turning or base & _ANGLES:
                return _affine(factor, unit, si)
            return Scale(si, factor * _turning(text, si, names))
        mass = _MASS.get(si)
        if mass is not None and dimensionality(mass) == dimension:
            return Scale(si, _affine(factor, unit, mass).factor * _STANDARD_GRAVITY)
    if text != text.lower():
        try:
            return scale_of(text.lower(), wanted)
        except UnitError:
            pass
    raise UnitError(f"found unit '{text}'", _allowed(wanted))


def _allowed(wanted: tuple[str, ...]) -> str:
    shown = [unit for unit in wanted if unit != "dimensionless"]
    return f"allowed: a unit of the dimension of {' or '.join(dict.fromkeys(shown))}"


def _affine(factor: float, unit: str, si: str) -> Scale:
    slope, offset = affine(unit, si)
    if offset and factor != 1.0:
        raise UnitError(f"found '{factor:g} {unit}'", f"allowed: {unit} without a factor, or {si}")
    return Scale(si, factor * slope, offset)


def _turning(text: str, si: str, names: tuple[tuple[str, int], ...]) -> float:
    """Radians of a unit without an angle: per minute it means revolutions, otherwise it is ambiguous."""
    if any(name == "min" for name, _ in names):
        minutes = sum(exponent for name, exponent in names if name == "min")
        return 2.0 * math.pi * 60.0**minutes
    turns = si.replace("rad", "rev")
    raise UnitError(
        f"found '{text}', which may mean {si} or {turns}",
        f"allowed: '{si}' where it is radians, '{turns}' where it is revolutions",
    )


def _base(names: tuple[tuple[str, int], ...]) -> frozenset[str]:
    return frozenset().union(*(base_units(name) for name, _ in names)) if names else frozenset()


def _parsed(text: str, wanted: tuple[str, ...]) -> tuple[float, tuple[tuple[str, int], ...]]:
    """Factor and names with exponents of a text, in pint's words."""
    refusal = UnitError(f"found '{text[:_LONGEST]}', which is not a unit", _allowed(wanted))
    if len(text) > _LONGEST:
        raise refusal
    plain = _normalised(text)
    if not plain:
        raise refusal
    factor, exponents, at = 1.0, {}, 0
    sign, outer, groups = 1, 1, []
    plain = WHOLE.get(plain.lower().replace(" ", ""), plain)
    while at < len(plain):
        match = _TOKEN.match(plain, at)
        if match is None:
            raise refusal
        if match["operator"] in ("*", "/") and plain[:at].rstrip()[-1:] in ("*", "/"):
            raise refusal  # a power of what is no number, or of a power
        at = match.end()
        if match["operator"] == "(":
            groups.append(outer)
            outer, sign = outer * sign, 1
            continue
        if match["operator"] == ")":
            if not groups:
                raise refusal
            outer, sign = groups.pop(), 1
            continue
        if match["operator"] or match["joint"]:
            sign = -1 if match["operator"] == "/" else 1
            continue
        if match["name"]:
            number, parts = _atom(match["name"], text, wanted)
            raised = int(match["inside"] or match["exponent"] or 1)
            power = outer * sign * raised
            if abs(power) > _HIGHEST or (len(parts) > 1 and abs(raised) > 1):  # kgcm2: of which is it the square?
                raise refusal
            for name, exponent in parts:
                exponents[name] = exponents.get(name, 0) + power * exponent
            factor *= number**power
        else:
            try:
                factor *= _number(match, refusal) ** (outer * sign)
            except ArithmeticError as error:  # 1e200**2, 1/sqrt(0)
                raise refusal from error
        sign = 1
    if groups or plain[-1] in "*/" or not (math.isfinite(factor) and factor > 0.0):
        raise refusal
    return factor, tuple((name, exponent) for name, exponent in exponents.items() if exponent)


def _number(match: re.Match[str], refusal: UnitError) -> float:
    if match["root"]:
        return math.sqrt(float(match["radicand"]))
    number, power = float(match["number"].replace(",", ".")), int(match["power"] or 1)
    if abs(power) > _LARGEST_POWER or number == 0.0:
        raise refusal
    return number**power


def _atom(name: str, text: str, wanted: tuple[str, ...]) -> tuple[float, tuple[tuple[str, int], ...]]:
    """Factor and units of one name."""
    if name in COUNTS or name.lower() in COUNTS:
        example = "turn/4096/s" if any("/s" in si for si in wanted) else "turn/4096"
        raise UnitError(
            f"found unit '{text}', counts of which the file does not tell what one is worth",
            f"{_allowed(wanted)}, e.g. '{example}' for an encoder of 4096 counts a turn, or '2.69 mA'",
        )
    if name.lower() in ELECTRICAL:
        raise UnitError(
            f"found '{text}', which is electrical", "allowed: the mechanical one, e.g. 'rpm/7' for 7 pairs of poles"
        )
    match = _NEWTON_METRES.fullmatch(name)
    if match:
        return 1.0, ((f"{match[1]}N", 1), (match[2], 1))
    if name == "peak_to_peak":
        raise UnitError(f"found '{text}', peak to peak", "allowed: A (peak) or Arms (effective)")
    if name == "grad":
        raise UnitError(f"found '{text}', which may mean degrees or gon", "allowed: 'deg' or 'gon'")
    found = ATOMS.get(name) or (
        ATOMS.get(name.lower()) if len(name) > 1 and (name.isupper() or name.istitle()) else None
    )
    return found if found is not None else (1.0, ((name, 1),))


def _normalised(text: str) -> str:
    plain = _RAISED.sub(lambda match: f"^{match[0].translate(_SUPERSCRIPTS)}", text.strip())
    for written, meant in TRANSLATED:
        plain = plain.replace(written, meant)
    plain = _PEAK_TO_PEAK.sub(lambda match: f"{match[1]}*peak_to_peak", plain)
    plain = EFFECTIVE.sub(lambda match: f"{match[1][0] if match[1][0] in 'munk' else ''}Arms", plain)
    plain = _COMMENT.sub("", _PEAK.sub(lambda match: match[1], plain))
    plain = re.sub(r"(?<=[^\W\d])\.(?=\s*(?:[/*]|$))", "", plain)  # of an abbreviation
    plain = re.sub(r"\bper\b", "/", plain)
    plain = re.sub(r"(?<![^\W\d/])[xX](?=\s*\d)|(?<=\d)\s*[xX](?=\s)", "*", plain).strip().lstrip("*").strip()
    if plain.startswith("(") and plain.endswith(")") and plain.count("(") == 1:
        plain = plain[1:-1]
    return plain.rstrip(".").strip()


def _spelled(names: tuple[tuple[str, int], ...]) -> str:
    """A unit as pint and `USUAL_UNITS` write it, e.g. `rad/s**2`."""
    above = "*".join(f"{name}**{exponent}" if exponent > 1 else name for name, exponent in names if exponent > 0)
    below = "".join(
        f"/{name}**{-exponent}" if exponent < -1 else f"/{name}" for name, exponent in names if exponent < 0
    )
    return (above or "1") + below if names else "dimensionless"


@cache
def is_unit(text: str) -> bool:
    """Whether a text is a unit, ambiguous ones included."""
    try:
        _, names = _parsed(text, ())
        dimensionality(_spelled(names))
    except UnitError as error:
        return not error.found.endswith("not a unit")
    except ValueError:
        return False
    return bool(names)


def spelled_for_pint(text: str) -> str:
    """A unit in pint's spelling, e.g. `N*m` for `Nm`; unchanged if it is no unit or has a factor."""
    try:
        factor, names = _parsed(text, ())
    except UnitError:
        return text
    return _spelled(names) if factor == 1.0 else text
