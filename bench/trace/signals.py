"""The signals a trace may hold: their names, SI units on rotary and linear axes, and dimensions allowed."""

from __future__ import annotations

from bench.axis_kind import KINDS, AxisKind
from bench.units import dimensionality

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

#: Torque may also come as a share of the rated torque (EPOS reports %); a rig's `rated_torque` makes it N*m.
RELATIVE_TORQUE = "dimensionless"


def unit_on(kind: AxisKind, name: str) -> str:
    """SI unit of signal `name` on an axis of a kind."""
    return SI_UNITS[name][KINDS.index(kind)]


def si_unit(name: str, unit: str) -> str | None:
    """SI unit in which signal `name`, recorded in `unit`, is kept; None if the dimension is wrong for it.

    Raises:
        ValueError: `unit` is not a unit.
    """
    dimension = dimensionality(unit)
    candidates = (*SI_UNITS[name], *((RELATIVE_TORQUE,) if name.startswith("torque") else ()))
    for candidate in candidates:
        if dimensionality(candidate) == dimension:
            return candidate
    return None
