"""The signals a trace may hold: their names, SI units on rotary and linear axes, and how recorders call them.

Conservative: only whole and unambiguous names are recognised; everything else goes through the rig's `[trace.columns]`.
"""

from __future__ import annotations

import re

from bench.axis_kind import KINDS, AxisKind
from bench.errors import InputError
from bench.units.conversion import UnitScale, scale_of
from bench.units.grammar import UnitError

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


def signal_of(name: str) -> str | None:
    """Signal that a column's name stands for; None when the name does not tell."""
    return _BY_ALIAS.get(plain_name(name))


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
