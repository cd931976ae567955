"""The signals a trace may hold: their names, SI units on rotary and linear axes, and how recorders call them.

Conservative: only whole and unambiguous names are recognised; everything else goes through the rig's `[trace.columns]`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache

from bench.axis_kind import KINDS, AxisKind
from bench.errors import InputError
from bench.units.conversion import UnitScale, scale_of
from bench.units.grammar import ALIASES as UNITS
from bench.units.grammar import UnitError, parse_unit

#: SI unit of each known signal, one for each of KINDS.
SI_UNITS: dict[str, tuple[str, str]] = {
    "position": ("rad", "m"),
    "velocity": ("rad/s", "m/s"),
    "acceleration": ("rad/s**2", "m/s**2"),
    "current": ("A", "A"),
    "torque": ("N*m", "N*m"),
    "force": ("N", "N"),
    "voltage": ("V", "V"),
    "temperature": ("K", "K"),
    "position_reference": ("rad", "m"),
    "velocity_reference": ("rad/s", "m/s"),
    "torque_reference": ("N*m", "N"),
}

#: What is known to act on an axis, which no file holds (`bench.trace.trace.with_known`).
KNOWN_TORQUE, KNOWN_MOMENTUM = "known_torque", "known_momentum"
#: Keys of a trace's metadata: where other joints of a robot were stated to stand, in words, and the torque that the
#: one of them that is felt most would put on the axis where it moves - N*m (N).
STANDING, STANDING_ASK = "standing", "standing_ask"

#: Torque may also come as a share of the rated torque (EPOS reports %); a rig's `rated_torque` makes it N*m.
RELATIVE_TORQUE = "dimensionless"
#: Other names of signals; compared in lower case, with `_` as a space, after the last dot of a PLC path.
ALIASES: dict[str, str] = {
    "time": "t|timestamp|zeit",
    "position": "actual position|actpos|lage|position actual value",
    "velocity": "actual velocity|actvel|speed|geschwindigkeit|velocity actual value|velocity actual value averaged",
    "acceleration": "actual acceleration|actacc",
    "current": "iq|strom|current actual value|current actual value averaged",
    "torque": "actual torque|torque actual value|torque actual value averaged|effort",
    "position_reference": "reference position|position demand value",
    "velocity_reference": "reference velocity|velocity demand value",
    "torque_reference": "reference torque|torque demand value",
}
#: Words in column names, in the languages of drives, and letters of the field.
WORDS: dict[str, str] = {
    "time": r"time|zeit|temps|tempo|tiempo|timestamp|stamp|ms_today|clock|uhrzeit|t",
    "velocity": r"vel|velo|velocit(?:y|ies)|speeds?|spd|geschw\w*|drehzahl\w*|vitesse|velocidad|velocita|omega|rpm|"
    r"erpm|dq|qd|qvel|qdot|n_?ist|nact|v_?ist|606c|60:?6c|vact|actvel\w*|r63|r0063|vl|w",
    "position": r"pos|position\w*|angles?|qpos|winkel|theta|enc|encoder|lage\w*|phi|weg|6064|actpos\w*|pl|q|x",
    "current": r"cur|curr|currents?|iq|i_q|isq|strom\w*|courant|corriente|amps?|r78|r0078|il|q_axis_current|i",
    "torque": r"torques?|trq|tq|moment|drehmoment\w*|effort\w*|taus?|couple|coppia|m_?ist|6077|r80|r0080|force|kraft",
    "voltage": r"volt\w*|spannung|uq|vq|vbus|udc|tension|u",
    "temperature": r"temp\w*|motor_temp",
    "acceleration": r"acc|accel\w*|beschl\w*",
}
REFERENCE = re.compile(
    r"set|action|soll\w*|ref|reference|cmd|command\w*|demand|target|goal|input|setpoint|sp|des|desired|consigne|"
    r"r62|r0062|607a|60ff",
    re.I,
)
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

#: What stands for a unit where there is none.
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
    known = _BY_ALIAS.get(plain_name(text))
    words = [part[0] for part in _PART.finditer(text)]
    return [known] if known else [name for name, known in _WORD_OF.items() if any(map(known.fullmatch, words))]


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
    """Whether a text is a unit of a drive, counts included; asks no library."""
    try:
        names = parse_unit(unit).powers
    except UnitError as error:
        return not error.found.endswith("not a unit")
    return bool(names) and all(map(_USUAL.fullmatch, names))


def _suits(unit: str, signal: str) -> bool:
    """Whether a signal may be in a unit: as far as it is known, where only the user knows what it is worth."""
    try:
        scale_of(unit, wanted_units(signal))
    except UnitError as error:
        return "counts" in error.found or "may mean" in error.found
    return True


def is_index(name: str) -> bool:
    """Whether a column's name says that it counts samples."""
    return _INDEX.fullmatch(plain_name(name)) is not None


def unit_of(text: str | None) -> str | None:
    """Unit as written; None for `(None)`, `-` or an empty text."""
    plain = (text or "").strip()
    return None if plain.lower() in _NO_UNIT else plain


def wanted_units(signal: str) -> tuple[str, ...]:
    """SI units in which a signal (or `time`) may be kept."""
    if signal == "time":
        return ("s",)
    relative = (RELATIVE_TORQUE,) if signal.startswith("torque") else ()
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
