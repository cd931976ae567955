"""Units of columns that carry none, as far as physics determines them; what is assumed is reported in one line.

A recording without any unit is read in SI where that is plausible: position and velocity agree, values are no counts
and within what an axis reaches, and the times are those of a recorder. Where other columns have units, a missing one is
only taken from physics: the position's derivative is the velocity.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bench.arrays import Array, correlation
from bench.trace.channel import Channel
from bench.trace.signals import RELATIVE, SI_UNITS, wanted_units
from bench.units.conversion import scale_or_none

#: Units of time, and the share by which a position and the integral of its velocity may differ in the right one.
TIMES, AGREEMENT = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}, 0.1
#: Other units of position and velocity, on a rotary and on a linear axis, SI first.
_USUAL = {
    "position": (("rad", "deg", "turn"), ("m", "mm", "um")),
    "velocity": (("rad/s", "deg/s", "rpm", "turn/s"), ("m/s", "mm/s", "m/min")),
}
#: Largest magnitude that is plausible without a unit - SI; a servo axis at 700 rad/s turns 6700 times a minute.
_PLAUSIBLE = {"velocity": 700.0, "current": 1e3, "torque": 1e4, "force": 1e6, "voltage": 2e3}
#: Names of a voltage as a share of the supply's, and the largest share without a unit, which rounding may exceed.
_DUTY, _FULL = re.compile(r"duty|pwm|tastgrad", re.IGNORECASE), 1.01
#: Whole numbers beyond this are counts, or thousandths; an example of an encoder's; sample periods of recorders - s.
_COUNTS, _COUNTED, _PERIODS = 30.0, "turn/4096", (2e-4, 2e-2)
#: Samples that are looked at, stretches they are cut into, and correlation below which motion determines no unit.
_ENOUGH, _STRETCHES, _ALIKE = 200_000, 1024, 0.9


@dataclass
class Assumption:
    """Units assumed by signal, and by signal why none is: what is wrong, and a unit to state."""

    units: dict[str, str] = field(default_factory=dict)
    refused: dict[str, tuple[str, str]] = field(default_factory=dict)


@np.errstate(over="ignore", invalid="ignore")  # implausible magnitudes determine nothing
def assumed_units(channels: Mapping[str, Channel], units: Mapping[str, str | None], bare: bool) -> Assumption:
    """Units of the signals (and `time`) that have none.

    Args:
        channels: of each signal.
        units: of each signal; None where it has none.
        bare: whether no column of the recording has a unit, but for times.
    """
    found = Assumption()
    scales = [scale_or_none(units[name] or "", wanted_units(name)) for name in _USUAL if units.get(name)]
    linear = "force" in channels or any(scale is not None and scale.unit.startswith("m") for scale in scales)
    usual = {name: units_of_kind[linear] for name, units_of_kind in _USUAL.items() if name in channels}
    for name, channel in channels.items():
        if units[name] is None and name != "time" and name != "temperature":
            duty = name == "voltage" and _DUTY.search(channel.name) is not None
            si = RELATIVE if duty else SI_UNITS[name][min(linear, len(SI_UNITS[name]) - 1)]
            top, counted = _largest(channel.values[:_ENOUGH])
            if duty:
                reason, instead = "and exceeds 1" if top > _FULL else None, "%"
            elif bare:
                reason = _implausible(name, top, counted, si)
                instead = _instead(name, top, counted, usual.get(name, (si,)))
            else:
                reason, instead = "where other columns have theirs", si
            found.refused |= {name: (reason, instead)} if reason else {}
            found.units |= {} if reason else {name: si}
    known = {name: units[name] or found.units.get(name) or usual[name][0] for name in usual}
    moved = _moved(channels, known)
    if "time" in channels and units["time"] is None:
        unit, reason = _time_unit(channels["time"].values[:_ENOUGH], moved)
        found.units |= {"time": unit} if reason is None else {}
        found.refused |= {} if reason is None else {"time": (reason, unit)}
    clock = units.get("time") or found.units.get("time")
    ratio = travel_ratio(*moved) if moved is not None and clock is not None else None
    if ratio is None or clock is None or all(units[name] is not None for name in usual):
        return found
    _compare(abs(ratio) / _factor("time", clock), usual, units, known, found)
    return found


def _compare(
    ratio: float,
    usual: Mapping[str, tuple[str, ...]],
    units: Mapping[str, str | None],
    known: Mapping[str, str],
    found: Assumption,
) -> None:
    """Take the one missing unit of position and velocity in which they agree; refuse both where they disagree.

    `ratio` is the change of position over the integral of velocity, in the units that are `known` or SI.
    """
    missing = [name for name in usual if units[name] is None]
    for name in missing if len(missing) == 1 else ():
        for unit in usual[name]:
            share = _factor(name, unit) / _factor(name, known[name])
            if abs((ratio * share if name == "position" else ratio / share) - 1.0) < AGREEMENT:
                found.units[name] = unit
                found.refused.pop(name, None)
                return
    if abs(ratio - 1.0) > AGREEMENT:
        for name in missing:
            found.units.pop(name, None)
            reason = f"and in {known[name]} the position changes by {ratio:.3g} times the integral of the velocity"
            found.refused[name] = (reason, usual[name][1])


def _moved(channels: Mapping[str, Channel], known: Mapping[str, str]) -> tuple[Array, Array, Array] | None:
    """Times as recorded, position and velocity - SI, (n,) each; None where one is missing or has another length."""
    if not {"time", "position", "velocity"} <= set(channels):
        return None
    ticks = channels["time"].values[:_ENOUGH]
    position, velocity = (channels[name].values[:_ENOUGH] * _factor(name, known[name]) for name in _USUAL)
    return (ticks, position, velocity) if ticks.size == position.size == velocity.size > 2 else None


def _factor(name: str, unit: str) -> float:
    scale = scale_or_none(unit, wanted_units(name))
    return scale.factor if scale is not None else np.nan


def _largest(values: Array) -> tuple[float, bool]:
    """Largest magnitude, NaN without two numbers, and whether all are whole numbers."""
    known = values[np.isfinite(values)]
    top = float(np.abs(known).max()) if known.size > 1 else np.nan
    return top, top > _COUNTS and bool((known == np.rint(known)).all())


def _implausible(name: str, top: float, counted: bool, si: str) -> str | None:
    """Why values without a unit are hardly SI; None where they may be."""
    if np.isnan(top):
        return "and contains no numbers"
    if counted:
        return f"and whole numbers up to {top:.6g} may be counts"
    return f"and {top:.3g} {si} is hardly reached" if top > _reached(name) else None


def _instead(name: str, top: float, counted: bool, usual: Sequence[str]) -> str:
    """A unit to state: of an encoder's counts, or the first usual one in which the largest value is reached."""
    if counted and usual[-1] == "turn":
        return _COUNTED
    reached = (unit for unit in usual[1:] if top * _factor(name, unit) <= _reached(name))
    return next(reached, usual[-1])


def _reached(name: str) -> float:
    return _PLAUSIBLE.get(name.removesuffix("_reference"), np.inf)


def _time_unit(ticks: Array, moved: tuple[Array, Array, Array] | None) -> tuple[str, str | None]:
    """Unit of times: in which position and velocity agree, or whose steps are usual; the reason where none is known."""
    unit = time_unit(*moved) if moved is not None else None
    if unit is not None:
        return unit, None
    steps = np.diff(ticks[np.isfinite(ticks)])
    step = float(np.median(steps)) if steps.size else 0.0
    whole = bool((steps == np.rint(steps)).all())
    low, high = _PERIODS
    if not whole and 0.05 * low <= step <= high:
        return "s", None
    for unit in ("ms", "us", "ns"):
        if whole and step > 1.0 and low <= step * TIMES[unit] <= high:
            return unit, None
    return "ms" if whole else "s", f"and steps of {step:.3g} {'may be samples' if whole else 'are unusual in s'}"


def time_unit(ticks: Array, position: Array, velocity: Array) -> str | None:
    """The unit in which times (n,) make a position and its velocity - SI, (n,) each - agree; None where none does."""
    second = travel_ratio(ticks, position, velocity)
    if second is None:
        return None
    return next((unit for unit, factor in TIMES.items() if abs(abs(second) / factor - 1.0) < AGREEMENT), None)


def travel_ratio(ticks: Array, position: Array, velocity: Array) -> float | None:
    """Change of position over the integral of velocity - (n,) each; None where the motion does not determine it.

    Both are summed over stretches, in which the noise of single samples averages out; wraps are left out.
    """
    step = np.diff(position)
    travelled = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(ticks)
    plain = np.isfinite(step) & np.isfinite(travelled) & (np.abs(step) < 0.2 * np.ptp(position))
    step, travelled = step[plain], travelled[plain]
    starts = np.arange(0, step.size, max(step.size // _STRETCHES, 1))
    if starts.size < 3:
        return None
    step, travelled = np.add.reduceat(step, starts), np.add.reduceat(travelled, starts)
    if abs(correlation(step, travelled)) < _ALIKE:
        return None
    return float(travelled @ step) / float(travelled @ travelled)
