"""Names under which recorders store the signals the bench knows, and how foreign unit texts read.

Conservative: a name is taken only as a whole and only when it can mean nothing else; everything else goes through the
rig's `[trace.columns]`.
"""

from __future__ import annotations

import re

from bench.errors import InputError
from bench.trace.signals import SI_UNITS, si_unit
from bench.unit_grammar import LONGEST
from bench.units import base_units, dimensionality

#: Besides its own name; compared in lower case, with `_` as a space, after the last dot of a PLC path.
ALIASES: dict[str, tuple[str, ...]] = {
    "time": ("t", "timestamp", "zeit"),
    "position": ("actual position", "actpos", "lage", "position actual value"),
    "velocity": (
        "actual velocity",
        "actvel",
        "speed",
        "geschwindigkeit",
        "velocity actual value",
        "velocity actual value averaged",
    ),
    "acceleration": ("actual acceleration", "actacc"),
    "current": ("iq", "strom", "current actual value", "current actual value averaged"),
    "torque": ("actual torque", "torque actual value", "torque actual value averaged"),
    "position_reference": ("reference position", "position demand value"),
    "velocity_reference": ("reference velocity", "velocity demand value"),
    "torque_reference": ("reference torque", "torque demand value"),
}

_BY_ALIAS = {alias: signal for signal, aliases in ALIASES.items() for alias in aliases}
_BY_ALIAS |= {signal.replace("_", " "): signal for signal in ("time", *SI_UNITS)}

#: Unit texts that pint reads as something else or not at all.
_FOREIGN_UNITS = {
    "Nm": "N*m",
    "mNm": "mN*m",
    "Ncm": "N*cm",
    "U/min": "rpm",
    "RPM": "rpm",
    "Grad": "deg",
    "Grad/s": "deg/s",
    "C": "degC",
}
_COMMENT = re.compile(r"\s*\(.*\)\s*$")

#: Base units that count things: pint calls them dimensionless as it does angles, yet they are no angle.
_NOT_AN_ANGLE = {"count", "percent", "permille", "ppm", "bit", "byte", "particle", "number"}


def signal_of(name: str) -> str | None:
    """Signal that a column's name stands for; None when the name does not tell."""
    return _BY_ALIAS.get(name.rsplit(".", 1)[-1].strip().lower().replace("_", " "))


def unit_of(text: str | None) -> str | None:
    """Unit as pint reads it, from the text in a file such as `V (Voltage)`; None for `(None)` or an empty text."""
    plain = (text or "").strip()
    plain = _COMMENT.sub("", plain).strip() if len(plain) <= LONGEST else plain
    return _FOREIGN_UNITS.get(plain, plain) or None


def checked_si_unit(signal: str, unit: str, place: str) -> str:
    """SI unit in which a signal recorded in `unit` is kept.

    Raises:
        InputError: no unit, or of the wrong dimension; names `place`.
    """
    wanted = ("s",) if signal == "time" else tuple(dict.fromkeys(SI_UNITS[signal]))
    allowed = f"allowed: a unit of the dimension of {' or '.join(wanted)}"
    try:
        si = _time_unit(unit) if signal == "time" else si_unit(signal, unit)
        counts = _NOT_AN_ANGLE & base_units(unit) if si is not None and "rad" in si else set()
    except ValueError as error:
        raise InputError(place, f"found '{unit}', which is not a unit", allowed) from error
    if si is None or counts:
        raise InputError(place, f"found unit '{unit}'", allowed)
    return si


def _time_unit(unit: str) -> str | None:
    return "s" if dimensionality(unit) == "[time]" else None
