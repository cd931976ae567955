"""The most common units of rig files and recordings, with what pint makes of them.

Importing pint and building its registry costs 0.2 s of CPU, a quarter of the run time of `bench identify`. A unit in
this table needs neither; all others, and every conversion except to SI, go through pint. A test compares each row with
pint.
"""

from __future__ import annotations

from typing import NamedTuple


class UsualUnit(NamedTuple):
    """A unit as pint reads it.

    Attributes:
        factor: to SI.
        dimensionality: as pint writes it.
        base_units: names of the units it is made of, without prefixes, separated by spaces.
    """

    factor: float
    dimensionality: str
    base_units: str


USUAL_UNITS: dict[str, UsualUnit] = {
    "s": UsualUnit(1.0, "[time]", "second"),
    "m": UsualUnit(1.0, "[length]", "meter"),
    "rad": UsualUnit(1.0, "dimensionless", "radian"),
    "A": UsualUnit(1.0, "[current]", "ampere"),
    "V": UsualUnit(1.0, "[mass] * [length] ** 2 / [time] ** 3 / [current]", "volt"),
    "K": UsualUnit(1.0, "[temperature]", "kelvin"),
    "N": UsualUnit(1.0, "[mass] * [length] / [time] ** 2", "newton"),
    "N*m": UsualUnit(1.0, "[mass] * [length] ** 2 / [time] ** 2", "meter newton"),
    "kg": UsualUnit(1.0, "[mass]", "gram"),
    "kg*m**2": UsualUnit(1.0, "[mass] * [length] ** 2", "gram meter"),
    "kg/m**3": UsualUnit(1.0, "[mass] / [length] ** 3", "gram meter"),
    "1/s": UsualUnit(1.0, "1 / [time]", "second"),
    "ohm": UsualUnit(1.0, "[mass] * [length] ** 2 / [time] ** 3 / [current] ** 2", "ohm"),
    "H": UsualUnit(1.0, "[mass] * [length] ** 2 / [time] ** 2 / [current] ** 2", "henry"),
    "rad/s": UsualUnit(1.0, "1 / [time]", "radian second"),
    "m/s": UsualUnit(1.0, "[length] / [time]", "meter second"),
    "rad/s**2": UsualUnit(1.0, "1 / [time] ** 2", "radian second"),
    "m/s**2": UsualUnit(1.0, "[length] / [time] ** 2", "meter second"),
    "V*s/rad": UsualUnit(1.0, "[mass] * [length] ** 2 / [time] ** 2 / [current]", "radian second volt"),
    "V*s/m": UsualUnit(1.0, "[mass] * [length] / [time] ** 2 / [current]", "meter second volt"),
    "N*m/A": UsualUnit(1.0, "[mass] * [length] ** 2 / [time] ** 2 / [current]", "ampere meter newton"),
    "N/A": UsualUnit(1.0, "[mass] * [length] / [time] ** 2 / [current]", "ampere newton"),
    "N*m/V": UsualUnit(1.0, "[time] * [current]", "meter newton volt"),
    "N/V": UsualUnit(1.0, "[time] * [current] / [length]", "newton volt"),
    "N*m*s/rad": UsualUnit(1.0, "[mass] * [length] ** 2 / [time]", "meter newton radian second"),
    "N*s/m": UsualUnit(1.0, "[mass] / [time]", "meter newton second"),
    "N*m/rad": UsualUnit(1.0, "[mass] * [length] ** 2 / [time] ** 2", "meter newton radian"),
    "N/m": UsualUnit(1.0, "[mass] / [time] ** 2", "meter newton"),
    "dimensionless": UsualUnit(1.0, "dimensionless", ""),
    "ms": UsualUnit(0.001, "[time]", "second"),
    "us": UsualUnit(1e-06, "[time]", "second"),
    "min": UsualUnit(60.0, "[time]", "minute"),
    "mm": UsualUnit(0.001, "[length]", "meter"),
    "cm": UsualUnit(0.01, "[length]", "meter"),
    "um": UsualUnit(1e-06, "[length]", "meter"),
    "deg": UsualUnit(0.017453292519943295, "dimensionless", "degree"),
    "mdeg": UsualUnit(1.7453292519943296e-05, "dimensionless", "degree"),
    "mrad": UsualUnit(0.001, "dimensionless", "radian"),
    "turn": UsualUnit(6.283185307179586, "dimensionless", "turn"),
    "deg/s": UsualUnit(0.017453292519943295, "1 / [time]", "degree second"),
    "deg/s**2": UsualUnit(0.017453292519943295, "1 / [time] ** 2", "degree second"),
    "rpm": UsualUnit(0.10471975511965977, "1 / [time]", "rpm"),
    "mm/s": UsualUnit(0.001, "[length] / [time]", "meter second"),
    "mm/s**2": UsualUnit(0.001, "[length] / [time] ** 2", "meter second"),
    "mA": UsualUnit(0.001, "[current]", "ampere"),
    "mV": UsualUnit(0.001, "[mass] * [length] ** 2 / [time] ** 3 / [current]", "volt"),
    "mN*m": UsualUnit(0.001, "[mass] * [length] ** 2 / [time] ** 2", "meter newton"),
    "N*cm": UsualUnit(0.01, "[mass] * [length] ** 2 / [time] ** 2", "meter newton"),
    "mN": UsualUnit(0.001, "[mass] * [length] / [time] ** 2", "newton"),
    "g": UsualUnit(0.001, "[mass]", "gram"),
    "mH": UsualUnit(0.001, "[mass] * [length] ** 2 / [time] ** 2 / [current] ** 2", "henry"),
    "kg*cm**2": UsualUnit(0.0001, "[mass] * [length] ** 2", "gram meter"),
    "kg*mm**2": UsualUnit(1e-06, "[mass] * [length] ** 2", "gram meter"),
    "g*cm**2": UsualUnit(1.0000000000000001e-07, "[mass] * [length] ** 2", "gram meter"),
    "g/cm**3": UsualUnit(999.9999999999999, "[mass] / [length] ** 3", "gram meter"),
    "kg/dm**3": UsualUnit(999.9999999999999, "[mass] / [length] ** 3", "gram meter"),
    "mN*m/A": UsualUnit(0.001, "[mass] * [length] ** 2 / [time] ** 2 / [current]", "ampere meter newton"),
    "mN*m*s/rad": UsualUnit(0.001, "[mass] * [length] ** 2 / [time]", "meter newton radian second"),
}
