"""The signals a trace may hold: their SI units on rotary and linear axes, and the names that recorders give them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache

from bench.axis_kind import KINDS, AxisKind
from bench.errors import InputError
from bench.units.conversion import UnitScale, scale_of
from bench.units.grammar import ALIASES as UNITS
from bench.units.grammar import UnitError, parse_unit

#: SI unit of each known signal, one for each of KINDS.
SI_UNITS: dict[str, tuple[str, str]] = {
    "position": ("rad", "m"),
    "load_position": ("rad", "m"),
    "velocity": ("rad/s", "m/s"),
    "acceleration": ("rad/s**2", "m/s**2"),
    "current": ("A", "A"),
    "torque": ("N*m", "N*m"),
    "force": ("N", "N"),
    "voltage": ("V", "V"),
    "supply_voltage": ("V", "V"),
    "temperature": ("K", "K"),
    "position_reference": ("rad", "m"),
    "velocity_reference": ("rad/s", "m/s"),
    "torque_reference": ("N*m", "N"),
}

#: What is known to act on an axis, which no file contains (`bench.trace.trace.with_known`).
KNOWN_TORQUE, KNOWN_MOMENTUM, KNOWN_INERTIA = "known_torque", "known_momentum", "known_inertia"
KNOWN_SLOPE = "known_slope"
#: Keys of a trace's metadata: where other joints of a robot were stated to stand, in words, and the torque that the
#: one of them that is felt most would put on the axis where it moves - N*m (N).
STANDING, STANDING_ASK = "standing", "standing_ask"

#: Torque may also come as a share of the rated torque (EPOS reports %), voltage as one of the supply's (a duty cycle).
RELATIVE = "dimensionless"
#: Other names of signals; compared in lower case, with `_` as a space, after the last dot of a PLC path.
ALIASES: dict[str, str] = {
    "time": "t|timestamp|zeit",
    "position": "actual position|actpos|lage|position actual value",
    "velocity": "actual velocity|actvel|speed|geschwindigkeit|velocity actual value|velocity actual value averaged",
    "acceleration": "actual acceleration|actacc",
    "current": "iq|strom|current actual value|current actual value averaged",
    "voltage": "duty|duty cycle|pwm|pwm duty|pwm duty cycle|tastgrad",
    "supply_voltage": "bus voltage|dc bus voltage|dc link voltage|battery voltage|input voltage|vbus|vbat|udc",
    "torque": "actual torque|torque actual value|torque actual value averaged|effort",
    "position_reference": "reference position|position demand value|goal|target|setpoint|desired|command|cmd",
    "velocity_reference": "reference velocity|velocity demand value",
    "torque_reference": "reference torque|torque demand value",
}
#: Words in column names, in the languages of drives.
WORDS: dict[str, str] = {
    "time": r"time|zeit|temps|tempo|tiempo|timestamp|stamp|clock|uhrzeit",
    "velocity": r"vel|velo|velocit(?:y|ies)|speeds?|spd|\w*geschw\w*|drehzahl\w*|vitesse|velocidad|velocita|omega|rpm|"
    r"erpm|dq|qd|qvel|qdot|actvel\w*|vl|ω",
    "position": r"pos|position\w*|angles?|qpos|winkel|theta|lage\w*|phi|weg|actpos\w*|pl|θ|ϑ|φ|ϕ",
    "current": r"cur|curr|currents?|iq|isq|strom\w*|courant|corriente|amps?|il",
    "torque": r"torques?|trq|tq|moment|drehmoment\w*|efforts?|taus?|couple|coppia|force|kraft|τ",
    "voltage": r"volt\w*|spannung|uq|vq|tension",
    "temperature": r"temp\w*",
    "acceleration": r"acc|accel\w*|beschl\w*",
}
#: What is a signal where no word determines one: an encoder, `q`, `eff` of a joint, and letters without a word.
LETTERS: dict[str, str] = {"q": "position", "enc": "position", "encoder": "position", "eff": "torque"}
_WITH_WORDS = frozenset(LETTERS)
LETTERS |= {"x": "position", "w": "velocity", "i": "current", "u": "voltage", "t": "time"}
#: Letters that mean something else as often: signals where their unit agrees.
VAGUE = {"v": "velocity", "n": "velocity", "m": "torque"}
LETTERS |= VAGUE
_SETPOINT = re.compile(
    r"set|action|soll\w*|ref|reference|referenz|cmd|command\w*|demand\w*|target|goal|input|setpoint|sp|des|desired|"
    r"consigne",
    re.I,
)
_MEASURED = re.compile(r"meas|measured|act|actual|act(?:pos|vel)\w*|present|feedback|fb|raw|ist", re.I)
#: Words for what is no signal of an axis; of currents and voltages, those of its supply.
_FOREIGN = re.compile(
    r"daxis|err|errors?|following|deviation|abweichung|schlepp\w*|limits?|lim|max\w*|power|leistung|efficiency|"
    r"utili[sz]ation|auslastung|wirkungsgrad|inertia|checksum|hours?|energy|energie|used|charged?",
    re.I,
)
_SUPPLY = re.compile(r"dc|bus|vbus|udc|link|dclink|in|batt?|battery|supply|mos", re.I)
#: Where a log keeps its joints: words that distinguish no joints.
_PLACE = re.compile(r"observations?|obs|states?|joint_?states?|joints|field|data|msg|log", re.I)
#: Words in compounds, as `Drehzahlsollwert` and `nist`, and other spellings of the currents of the q and the d axis.
_STEM = r"drehzahl|lage|moment|strom|geschwindigkeits?|winkel|positions?|kraft|spannungs?"
_COMPOUNDS = (
    (re.compile(rf"({_STEM})(soll|ist)(?:werte?)?", re.I), r"\1_\2"),
    (re.compile(rf"(?<![^\W\d_])(soll|ist)(?:wert)?(?={_STEM})", re.I), r"\1_"),
    (re.compile(r"(?<![^\W_])([nvmiqxw])(soll|ist|act|ref|cmd|set|des)(?![^\W\d_])", re.I), r"\1_\2"),
    (re.compile(r"(?<![^\W_])([iuv])_([qd])(?![^\W\d_])", re.I), r"\1\2"),
    (re.compile(r"(?<![^\W_])(d)[_\s-](axis)(?![^\W_])", re.I), r"\1\2"),
)
_PATH, _WORD = re.compile(r"[\s./()\[\],;:|]+"), re.compile(r"0x[0-9a-f]+|[^\W\d_]+|\d+", re.I)
_CAMEL = re.compile(r"(?<=[^\W\d_A-Z])(?=[A-Z])")
_WORD_OF = {signal: re.compile(rf"(?:{words})\d*", re.I) for signal, words in WORDS.items()}
#: Units in a name: in round or curly brackets; behind a slash, a comma, a dash or `in`; parts of a name.
_BRACKETS = re.compile(r"(.*?)\s*[({]([^(){}]*(?:\([^()]*\))?[^(){}]*)[)}]\s*")
_MARKED = re.compile(r"(.*?[^\s/])(?:\s*/\s*|\s*,\s*|\s+-\s+|\s+in\s+)(\([^()]+\)|[^\s(),]+)")
_PART = re.compile(
    r"(?<![A-Za-z])[mukn]?(?:Nm|N|A|V|Hz)(?:rms)?(?![A-Za-z])|[A-Z]?[^\W\d_A-Z]+2?|[A-Z]+(?![a-z])2?|\d|[%°]"
)
#: Characters of a name in which a unit is sought; ends of names that are no unit there; names of units that are.
LONGEST_NAME = 200
_NO_SUFFIX = frozenset(("in", "raw", "unit", "units", "step", "steps", "bit", "bits", "lu", "uu", "pu", "el"))
_ANGLE = re.compile(r"(?:angle|theta|phi|winkel|(?<![^\W_])q)[\W_]*$", re.I)
_USUAL = re.compile(
    r"[numckdM]?(?:g|m|s|A|K|N|V|W|Hz|rad|deg|rpm)|turn|min|deg[CF]|percent|permille|inch|foot|pound\w*|ounce\w*"
)
#: Names of columns that count samples.
_INDEX = re.compile(
    r"samples?|sample (index|number|no\.?|nr)|index|idx|n|nr\.?|no\.?|row|abtastung|point|cycle|ticks?|count|counter"
)
_BY_ALIAS = {alias: signal for signal, aliases in ALIASES.items() for alias in aliases.split("|")}
_BY_ALIAS |= {signal.replace("_", " "): signal for signal in ("time", *SI_UNITS)}

#: Texts in place of a unit where there is none.
_NO_UNIT = frozenset(("", "(none)", "none", "-", "--", "n/a", "na", "null", "(-)", "?"))


def unit_on(kind: AxisKind, name: str) -> str:
    """SI unit of signal `name` on an axis of a kind."""
    return SI_UNITS[name][KINDS.index(kind)]


def plain_name(name: str) -> str:
    """Last part of a name in lower case, by which names are compared."""
    return name.lstrip("#% ").rsplit(".", 1)[-1].lower().replace("_", " ").strip()


@cache
def signal_of(name: str) -> str | None:
    """Signal of a column's name, with or without a unit in it; None where it is not a name of a signal."""
    return _BY_ALIAS.get(plain_name(name)) or _BY_ALIAS.get(plain_name(unit_in_name(name)[0]))


@cache
def unit_in_name(name: str) -> tuple[str, str | None]:
    """A column's name without the unit in it, and that unit; the name as it is and None where it has none.

    `vel (rpm)`, `v / (m/s)`, `Strom in A`, `Speed, rpm`, `velocity_rad_s`, `timeMs`. A unit behind a mere mark must
    suit the signal: `torque_nm` is in N*m, `speed_ms` in m/s, `time_ms` in ms, and `omega_m` has no unit.
    """
    if len(name) > LONGEST_NAME:
        return name, None
    for pattern in (_BRACKETS, _MARKED):
        if (match := pattern.fullmatch(name)) is not None:
            bare, unit = match[1].strip(" /,"), match[2].strip("() ")
            plain = (pattern is _BRACKETS or " / " in name) and (len(unit) > 1 or unit in "sVANKC") and _is_usual(unit)
            if plain or _fitting(_signals_in(bare), [unit]) is not None:
                return bare, unit
    parts = [(part[0], part.start()) for part in _PART.finditer(name)]
    for count in range(min(4, len(parts)), 0, -1):
        bare, last = name[: parts[-count][1]], [part for part, _ in parts[-count:]]
        signals = _signals_in(bare) or (_signals_in(name) if count == 1 else [])
        known = last[0].lower() in _NO_SUFFIX or (last == ["m"] and _ANGLE.search(bare) is not None)
        unit = _fitting(signals, _spellings(last)) if count > 1 or not known else None
        if unit is not None:
            return bare.rstrip(" _.-:") or name, unit
    return name, None


def _signals_in(text: str) -> list[str]:
    """Signals that a name's words speak of, without its unit."""
    known, name = _BY_ALIAS.get(plain_name(text)), read_name(text)
    told = name.told if name.told or name.letter is None else {LETTERS[name.letter]}
    return [known] if known else [signal for signal in WORDS if signal in told]


def _spellings(parts: list[str]) -> Iterator[str]:
    """Units that the last parts of a name may spell: `rad s` is rad/s, `degs` deg or deg/s, `nm` Nm, `ma` mA."""
    words = [part.lower() if part.istitle() and part not in UNITS else part for part in parts if part != "per"]
    words = ["N" if word == "n" else word for word in words]
    if len(words) > 1:
        power = words.pop() if words[-1] in ("2", "1") else ""
        yield from (f"{mark.join(words)}{'-' * (power == '1')}{power}" for mark in ("/", "*", ""))
        return
    (word,) = words or [""]
    if len(word) == 1 and word not in "smavnkcSMAVNKC":
        return
    yield from (word, re.sub(r"^([mukc]?)n(?=[cm]?m$)", r"\1N", word), word[:-1] + word[-1:].upper(), word.title())
    yield from (f"{word[: -len(end)]}/{end.strip('p')}" for end in ("ps2", "s2", "ps", "s") if word.endswith(end))


def _fitting(signals: Iterable[str], spellings: Iterable[str]) -> str | None:
    """The first spelling that is a usual unit of one of the signals, or counts of it; None where there is none."""
    units = [unit for unit in spellings if _is_usual(unit)]
    return next((unit for unit in units for signal in signals if _suits(unit, signal)), None)


def _is_usual(unit: str) -> bool:
    """Whether a text is a unit of a drive, counts included; without a library."""
    try:
        names = parse_unit(unit).powers
    except UnitError as error:
        return not error.found.endswith("not a unit")
    return bool(names) and all(map(_USUAL.fullmatch, names))


def _suits(unit: str, signal: str) -> bool:
    """Whether a signal may be in a unit: as far as it is known, where only the user can state its scale."""
    try:
        scale_of(unit, wanted_units(signal))
    except UnitError as error:
        return "counts" in error.found or "may mean" in error.found
    return True


def is_index(name: str) -> bool:
    """Whether a column's name means that it counts samples."""
    return _INDEX.fullmatch(plain_name(name)) is not None


@dataclass(frozen=True)
class ColumnName:
    """What the words of a column's name mean.

    Attributes:
        told: signals of its words, more than one where they are ambiguous.
        letter: of LETTERS, where no word names a signal.
        setpoint, measured: whether a word states it.
        foreign, supply: whether it is of something else than the axis, or of its supply.
        joint: the other words, by which joints differ.
        words: those that have a meaning, in lower case.
    """

    told: frozenset[str]
    letter: str | None
    setpoint: bool
    measured: bool
    foreign: bool
    supply: bool
    joint: str
    words: frozenset[str]


def read_name(text: str) -> ColumnName:
    """What the words of a column's name, without its unit, mean."""
    text = text[:LONGEST_NAME]
    for pattern, apart in _COMPOUNDS:
        text = pattern.sub(apart, text)
    parts = [part for part in _PATH.split(text) if part]
    places = {part for part in parts if _PLACE.fullmatch(part)}
    words = {part: [piece for word in _WORD.findall(part) for piece in _pieces(word)] for part in parts}
    every = [word for part in parts for word in words[part]]
    told = _unambiguous(set().union(*map(_signals_of, every)))
    letters = [] if told else [word for part in parts for word in words[part] if _is_letter(word, words[part])]
    meaning, joint = {word for word in every if _signals_of(word)} | {*letters[-1:]}, list[str]()
    for part in parts:
        plain = not meaning.isdisjoint(words[part]) or sum(not word.isdigit() for word in words[part]) == 1
        gone = {word for word in words[part] if word in meaning or (plain and _is_modifier(word))}
        others = [word for word in words[part] if word not in gone]
        meaning |= gone
        if others and part not in places:
            joint.append("_".join(others) if gone else part.strip("_"))
    return ColumnName(
        told=told,
        letter=letters[-1].lower() if letters else None,
        setpoint=any(map(_SETPOINT.fullmatch, meaning)),
        measured=any(map(_MEASURED.fullmatch, meaning)),
        foreign=any(map(_FOREIGN.fullmatch, every)),
        supply=any(map(_SUPPLY.fullmatch, every)),
        joint=".".join(joint),
        words=frozenset(word.lower() for word in meaning | places),
    )


def _pieces(word: str) -> list[str]:
    """A word, or where one of them names a signal, the words that capital letters join in it."""
    pieces = [] if _signals_of(word) else _CAMEL.split(word)
    return pieces if any(map(_signals_of, pieces)) else [word]


def _signals_of(word: str) -> set[str]:
    return set() if word.isdigit() else {signal for signal, pattern in _WORD_OF.items() if pattern.fullmatch(word)}


def _is_modifier(word: str) -> bool:
    return _SETPOINT.fullmatch(word) is not None or _MEASURED.fullmatch(word) is not None


def _is_letter(word: str, part: list[str]) -> bool:
    """Whether a word of a part of a name is the letter of a signal."""
    others = (one for one in part if one is not word and not one.isdigit() and not _is_modifier(one))
    return word.lower() in LETTERS and (word.lower() in _WITH_WORDS or not any(others))


def _unambiguous(told: set[str]) -> frozenset[str]:
    """Signals less those that other words make something else: an angular speed, the current position."""
    motion = [signal for signal in ("acceleration", "velocity", "position") if signal in told]
    return frozenset(told - {*motion[1:]} - ({"current"} if motion else set()))


def unit_of(text: str | None) -> str | None:
    """Unit as written; None for `(None)`, `-` or an empty text."""
    plain = (text or "").strip()
    return None if plain.lower() in _NO_UNIT else plain


def wanted_units(signal: str) -> tuple[str, ...]:
    """SI units in which a signal (or `time`) may be kept."""
    if signal == "time":
        return ("s",)
    relative = (RELATIVE,) if signal.startswith("torque") or signal == "voltage" else ()
    return (*dict.fromkeys(SI_UNITS[signal]), *relative)


def scale_in(signal: str, unit: str, place: str) -> UnitScale:
    """How a signal (or `time`) recorded in `unit` becomes SI.

    Raises:
        InputError: no unit, one of the wrong dimension, or of two meanings; names `place`.
    """
    try:
        return scale_of(unit, wanted_units(signal))
    except UnitError as error:
        raise InputError(place, error.found, error.allowed) from error
