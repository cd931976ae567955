"""The grammar of units: a product of numbers and names, each with an exponent, read from left to right.

`*`, `/`, a blank, or a hyphen or point between names separates them: `kg*m**2`, `rad s-1`, `oz-in`, `turn/4096/s`,
`N*m*(s/rad)**0.5`. Numbers become a factor. Length, powers and brackets are limited: nothing here takes long, whatever
a file contains.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace

#: Signs replaced before anything is read, and after them texts, in this order.
_SIGNS = str.maketrans("µμº˚·⋅∙•×−–\u00a0\u202f", "uu°°*****--  ")
TRANSLATED = {
    "℃": "degC",
    "° C": "degC",
    "°C": "degC",
    "°F": "degF",
    "°K": "K",
    "°": " deg ",
    "‰": " permille ",
    "\u2126": "ohm",
    "\u03a9": "ohm",
    "Ohm": "ohm",
    "√2": "sqrt(2) ",
    "r.p.m": "rpm",
    "об/мин": "rpm",
    "об/с": "turn/s",
}

#: Whole texts that are no product, by their meaning; in lower case without blanks.
_WHOLE = {
    "rad/s^2": "rad/ss",
    "deg/s^2": "deg/ss",
    "mm/s^2": "mm/ss",
    "m/s^2": "m/ss",
    "permille": "1/1000 permil permill promille perthousand /thousand parts/thousand",
    "percent": "percent prozent",
}

#: Names of units, in the languages of drives, by what they mean; one of several letters also in capitals or with the
#: first one.
_ALIASES = {
    "turn": "rev revs revolution revolutions r R U u umdr umdrehung umdrehungen tr tour tours turns turn rot rotation "
    "rotations giri giro obr ot varv omw upr",
    "rpm": "rpm RPM upm tpm",
    "deg": "deg degs degree degrees Grad ° grados gradi",
    "grade": "gon gradian gradians",
    "rad": "rad rads radian radians",
    "s": "s S sec secs second seconds sek sekunde sekunden seg segundo segundos seconde secondes secondo secondi",
    "ms": "ms mS msec msecs millisec millisecond milliseconds millis millisekunden millisecondes",
    "us": "us uS usec usecs microsec microsecond microseconds micros",
    "ns": "ns nsec nanosec nanosecond nanoseconds nanos",
    "min": "min mins minute minutes minuten mn minuto minuti minutos",
    "hour": "h hr hrs std",
    "A": "A a amp amps ampere amperes",
    "V": "V v volt volts vdc",
    "percent": "% percent prozent pct",
    "permille": "permille promille",
    "degC": "C degC celsius",
    "degF": "F degF fahrenheit",
    "m": "metre metres meter meters",
    "um": "micron microns",
    "inch": "in inch inches zoll",
    "foot": "ft foot feet",
    "pound": "lb lbs",
    "ounce": "oz",
    "pound_force": "lbf",
    "ounce_force": "ozf",
    "kilogram_force": "kgf kp",
    "gram_force": "gf p",
    "N": "newton newtons",
    "1000*rpm": "krpm kRPM",
    "turn/s": "rps",
    "deg/s": "dps",
    "inch/s": "ips",
    "sqrt(2)*A": "Arms",
    "sqrt(2)*mA": "mArms",
    "sqrt(2)*uA": "uArms",
    "sqrt(2)*kA": "kArms",
    "gram_force*cm": "gfcm gcm",
    "kilogram_force*cm": "kgfcm kgcm",
    "kilogram_force*m": "kgfm kgm",
    "ounce_force*inch": "ozin inoz ozfin",
    "pound_force*inch": "lbin inlb lbfin inlbf inlbs",
    "pound_force*foot": "lbft ftlb lbfft ftlbf ftlbs",
    "N*m": "NM newtonmeter newtonmetre",
}

#: What a drive counts or scales by settings of its own; one of them is worth what only the user can state.
_COUNTS = (
    "inc incs incr increment increments ink inkr inkremente cnt cnts ct cts count counts pulse pulses pls ppr tick "
    "ticks lsb digit digits raw bit bits step steps usteps microsteps qc quadcounts uu puu unit units lu cps pps "
    "pulsos impulse imp pu adc"
)
#: Of the electrical angle, whose turns are the rotor's times its pairs of poles.
_ELECTRICAL = "erpm eradians erad edeg el elec electrical elektrisch"

WHOLE = {name: meaning for meaning, names in _WHOLE.items() for name in names.split()}
ALIASES = {name: meaning for meaning, names in _ALIASES.items() for name in names.split()}
_BASES = "A V W N H K g m s rad deg rpm Arms Nm"
_CAPITALS = {f"{prefix}{base}".upper(): f"{prefix}{base}" for prefix in "muk" for base in _BASES.split()}
_CAPITALS |= {name.upper(): name for name in ("cm", "Ncm", "Nmm", "Arms")}
COUNTS, ELECTRICAL = frozenset(_COUNTS.split()), frozenset(_ELECTRICAL.split())


#: Characters of a unit; no recorder writes a longer one, nor higher powers. `kg*m**2/s**3/A**2` has 17.
LONGEST, _HIGHEST, _LARGEST_POWER, _DEEPEST = 80, 9, 64, 6

_TOKEN = re.compile(
    r"\s*(?:"
    r"(?P<root>sqrt\s*\(\s*(?P<radicand>\d+(?:\.\d+)?)\s*\))"
    r"|(?:(?P<number>\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)|(?P<name>[^\W\d]+|%)|(?P<close>\)))"
    r"(?:\s*(?:\^|\*\*)\s*(?P<power>\(\s*[+-]?\d+(?:[./]\d+)?\s*\)|[+-]?\d+(?:\.\d+)?(?![\d.,]))"
    r"|(?<=[^\W\d]|%)(?P<exponent>\([+-]?\d\)|[+-]?\d(?![\d.,])))?"
    r"|(?P<operator>[*/(])"
    r"|(?P<joint>(?<=[^\W\d])[-.](?=[^\W\d]))"
    r")"
)
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻", "0123456789+-")
_RAISED = re.compile("[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+")
#: An effective current, however it is written.
EFFECTIVE = re.compile(r"(?<![^\W_])([munk]?A|[mk]?Amps?)[\s_.-]*\(?(rms|eff|effektiv|effective)\)?(?![^\W_])", re.I)
_PEAK = re.compile(r"(?<![^\W_])([munk]?A)[\s_.-]*\(?(0-pk|pk|peak|p)\)?(?![^\W_])", re.I)
_RUN_TOGETHER = re.compile(r"(da|[unmcdkM]?)([NVW])(?!$)([cmk]?m)?(s|min)?")
_MASS_BY_AREA = re.compile(r"(kg|g|mg|lb|oz)([mc]?m|in|ft)", re.I)
_PEAK_TO_PEAK = re.compile(r"(?<![^\W_])([munk]?A)[\s_.-]*\(?(pp|pk-pk|p-p|pkpk)\)?(?![^\W_])", re.I)
_COMMENT = re.compile(r"(?<=[^\s*/])\s*\((?!.*(?:eff|rms|peak|pk|el))[^()\d]{3,}\)\s*$", re.I)


class UnitError(ValueError):
    """A text that is no unit, or not plainly one: `found` is what it is, `allowed` what would be; `example`: one."""

    def __init__(self, found: str, allowed: str, example: str | None = None) -> None:
        self.found, self.allowed, self.example = found, allowed, example
        super().__init__(f"{found}; {allowed}")


@dataclass
class UnitProduct:
    """A factor times powers of names.

    Attributes:
        factor: of it.
        powers: exponent by name, in the order of their appearance.
        note: what was assumed of a name.
        sign: +1, or -1 behind a `/`: of the exponent of what comes next.
    """

    factor: float = 1.0
    powers: dict[str, float] = field(default_factory=dict)
    note: str = ""
    sign: int = 1

    def take(self, other: UnitProduct, exponent: float) -> None:
        """Multiply by, or behind a `/` divide by, a power of another product.

        Raises:
            ArithmeticError: no number can represent the factor.
            ValueError: a power that no unit has.
        """
        exponent *= self.sign
        self.note = self.note or other.note
        self.factor, self.sign = self.factor * other.factor**exponent, 1
        for name, power in other.powers.items():
            raised = self.powers.pop(name, 0.0) + power * exponent
            if abs(power * exponent) > _HIGHEST:
                raise ValueError(f"{name} to the power of {raised:g}")
            if raised:
                self.powers[name] = raised

    def __str__(self) -> str:
        """As SI writes it and pint reads it, without its factor, e.g. `rad/s**2`."""
        raised = {name: f"{name}**{abs(power):g}" if abs(power) != 1 else name for name, power in self.powers.items()}
        above = "*".join(raised[name] for name, power in self.powers.items() if power > 0)
        below = "".join(f"/{raised[name]}" for name, power in self.powers.items() if power < 0)
        return (above or "1") + below if self.powers else "dimensionless"


def allowed(wanted: tuple[str, ...]) -> str:
    """What may stand where units of some dimensions are wanted, for messages."""
    shown = [unit for unit in wanted if unit != "dimensionless"]
    return f"allowed: a unit of the dimension of {' or '.join(dict.fromkeys(shown))}"


def parse_unit(text: str, wanted: tuple[str, ...] = ()) -> UnitProduct:
    """A unit as people and recorders write it, its names as SI and pint have them.

    Args:
        text: as written.
        wanted: SI units of the dimensions that it should have, for messages.

    Raises:
        UnitError: no unit, or one that only the user can state.
    """
    refusal = UnitError(f"found '{text[:LONGEST]}', which is not a unit", allowed(wanted))
    if len(text) > LONGEST:
        raise refusal
    plain = _normalised(text)
    if not plain.replace("\t", " ").isprintable():
        raise refusal
    plain = WHOLE.get(plain.lower().replace(" ", ""), plain)
    groups, at, open_ended = [UnitProduct()], 0, True
    while at < len(plain):
        match = _TOKEN.match(plain, at)
        if match is None or (match["operator"] in ("*", "/") and plain[:at].rstrip()[-1:] in ("*", "/")):
            raise refusal  # among others a power of what is no number, or of a power
        at, open_ended = match.end(), match["operator"] is not None
        try:
            _add(match, groups, text, wanted)
        except UnitError:
            raise
        except (ArithmeticError, LookupError, ValueError) as error:  # 1e200**2, 1/sqrt(0); a bracket that never opened
            raise refusal from error
    found = groups[-1]
    if len(groups) > 1 or open_ended or not (math.isfinite(found.factor) and found.factor > 0.0):
        raise refusal
    return found


def _add(match: re.Match[str], groups: list[UnitProduct], text: str, wanted: tuple[str, ...]) -> None:
    """Take one token into the innermost group."""
    if match["operator"] == "(":
        groups.append(UnitProduct())
        if len(groups) > _DEEPEST:
            raise ValueError("brackets in one another")
        return
    if match["operator"] or match["joint"]:
        groups[-1].sign = -1 if match["operator"] == "/" else 1
        return
    if match["close"]:
        taken = groups.pop()
    elif match["name"]:
        taken = _named(match["name"], text, wanted)
    elif match["root"]:
        taken = UnitProduct(math.sqrt(float(match["radicand"])))
    else:
        taken = UnitProduct(float(match["number"].replace(",", ".")))
    above, _, below = (match["power"] or match["exponent"] or "1").strip("()").partition("/")
    exponent = float(above) / float(below or 1)
    area = _MASS_BY_AREA.fullmatch(match["name"] or "") if exponent == 2.0 else None
    if area:
        taken, exponent = parse_unit(f"{area[1].lower()}*{area[2].lower()}**2"), 1.0
    elif match["name"] and len(taken.powers) > 1 and abs(exponent) > 1:
        raise ValueError(f"of which of {', '.join(taken.powers)} it is the power")
    if match["number"] and (abs(exponent) > _LARGEST_POWER or taken.factor == 0.0):
        raise ValueError("a number that is none")
    groups[-1].take(taken, exponent)


def _named(name: str, text: str, wanted: tuple[str, ...]) -> UnitProduct:
    """The meaning of one name."""
    if name in COUNTS or name.lower() in COUNTS:
        of_turn = {"rad": "turn/4096", "rad/s": "turn/4096/s"}
        turned = next((of_turn[si] for si in wanted or ("rad",) if si in of_turn), None)
        example = turned or ("2.69 mA" if "A" in wanted else f"0.001 {wanted[0]}")
        found = f"found unit '{text}', counts without a scale in the file"
        known = " for an encoder of 4096 counts a turn" if turned else ""
        raise UnitError(found, f"{allowed(wanted)}, e.g. '{example}'{known}", example)
    if name.lower() in ELECTRICAL:
        mechanical = "allowed: the mechanical one, e.g. 'rpm/7' for 7 pairs of poles"
        raise UnitError(f"found '{text}', which is electrical", mechanical, "rpm/7")
    capitals = _CAPITALS.get(name.upper()) if name.isupper() or name.startswith("M") else None
    if capitals and name[1:] == capitals[1:] and name[0] == "M":
        if not wanted or {"N*m/rad", "N/m"} & set(wanted):
            return UnitProduct(1e9, parse_unit(capitals).powers)
        if name == "MN":
            raise UnitError(f"found '{text}', which may mean mN or millions of N", "allowed: 'mN', or '1000 kN'")
        return replace(parse_unit(capitals), note=f"{name} taken as {capitals}: no axis has millions of {name[1:]}")
    if capitals:
        return parse_unit(capitals)
    match = _RUN_TOGETHER.fullmatch(name)
    if match:
        return UnitProduct(1.0, {part: 1 for part in (match[1] + match[2], match[3], match[4]) if part})
    if name == "peak_to_peak":
        raise UnitError(f"found '{text}', peak to peak", "allowed: A (peak) or Arms (effective)")
    if name == "grad":
        raise UnitError(f"found '{text}', which may mean degrees or gon", "allowed: 'deg' or 'gon'")
    for key in (name, name.lower()) if len(name) > 1 and (name.isupper() or name.istitle()) else (name,):
        if ALIASES.get(key, name) != name:
            return parse_unit(ALIASES[key])
    return UnitProduct(1.0, {name: 1})


def _normalised(text: str) -> str:
    plain = _RAISED.sub(lambda match: f"^{match[0].translate(_SUPERSCRIPTS)}", text.strip().translate(_SIGNS))
    for written, meant in TRANSLATED.items():
        plain = plain.replace(written, meant)
    plain = _PEAK_TO_PEAK.sub(lambda match: f"{match[1]}*peak_to_peak", plain)
    plain = EFFECTIVE.sub(lambda match: f"{match[1][: match[1].upper().index('A')]}Arms", plain)
    plain = _COMMENT.sub("", _PEAK.sub(lambda match: match[1], plain))
    plain = re.sub(r"(?<=[^\W\d])\.(?=\s*(?:[/*]|$))", "", plain)  # of an abbreviation
    plain = re.sub(r"\b(per|pro|par|por|al)\b", "/", plain, flags=re.I)
    plain = re.sub(r"(?<=[^\W\d])\s*/\s*(\d+)\s*(?=rpm)", r"/\1/", plain, flags=re.I)  # V/1000 rpm
    plain = re.sub(r"(?<![^\W\d/])[xX](?=\s*\d)|(?<=\d)\s*[xX](?=\s)", "*", plain).strip().lstrip("*").strip()
    if plain.startswith("(") and plain.endswith(")") and plain.count("(") == 1:
        plain = plain[1:-1]
    return plain.rstrip(".").strip()
