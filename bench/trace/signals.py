"""The signals a trace may hold: their names, SI units on rotary and linear axes, and dimensions allowed."""

from __future__ import annotations

from bench.axis_kind import KINDS, AxisKind

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

#: What is known to act on an axis, which no file holds (`bench.trace.known_torque`).
KNOWN_TORQUE, KNOWN_MOMENTUM = "known_torque", "known_momentum"

#: Torque may also come as a share of the rated torque (EPOS reports %); a rig's `rated_torque` makes it N*m.
RELATIVE_TORQUE = "dimensionless"


def unit_on(kind: AxisKind, name: str) -> str:
    """SI unit of signal `name` on an axis of a kind."""
    return SI_UNITS[name][KINDS.index(kind)]
