"""A physical quantity: its name, SI unit and bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Quantity:
    """A physical quantity: what it is called, its SI unit and what values physics allows.

    Attributes:
        name: the field's term, e.g. `moment_of_inertia`.
        symbol: its letter in equations, e.g. `J`.
        unit: SI unit as pint reads it, e.g. `kg*m**2`.
        lower, upper: closed bounds in that unit.
        angle: whether it stays an angle on a linear axis, where other angles become lengths.
        linear_unit: SI unit on a linear axis, where it is not the rotary one with metres and newtons in it.
        null: value at which what it belongs to is exactly absent, if one says so.
        preset: value that it has where none is given, if it need not be.
        instant: whether it is a time of the recording, whose zero means nothing.
        minor: whether what it belongs to is known without it, as with how an effect divides between dry and viscous.
    """

    name: str
    symbol: str
    unit: str
    lower: float = -math.inf
    upper: float = math.inf
    angle: bool = False
    linear_unit: str | None = None
    null: float | None = None
    preset: float | None = None
    instant: bool = False
    minor: bool = False
