"""The parameters of a drive with a cascade from the law that its recorded torque follows, and what a rig states."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from bench.axis_kind import AxisKind
from bench.parameter import Parameter
from bench.rig.rig import Drive
from bench.servos.law import ACCELERATION, BENT, ERROR, GOAL, LATE, RATE, SPEED, SUM, Law
from bench.servos.quantities import Agreement, Quantities, Values

#: Samples by which a reference or a speed may be late; what shows no more than that distinguishes no gains.
TIMING = 2.0
#: A gain whose interval is wider than this share of it is not determined; share of the speed that is not fed forward
#: from which on a controller whose integral is of the position alone is distinguished from a cascade.
DETERMINED, PARTIAL = 0.5, 0.1
#: Half widths by which a stated value has to differ to be contradicted.
CONTRADICTS = 2.0
#: Combinations that are determined where two gains may be exchanged.
COMBINED = {"velocity_gain*position_gain + integral_gain": "kp", "position_gain*integral_gain": "ki"}
#: Keys of `[drive]`, and what would separate them.
GAINS = "position_gain", "velocity_gain", "integral_gain", "inertia_feedforward"
ADVICE = "position_gain and integral_gain: the same motion with half of the speed feed-forward, or without it."


def by_stated(drive: Drive) -> dict[str, float]:
    """Coefficients of the law that a rig states."""
    kp, kv, ki = drive.position_gain, drive.velocity_gain, drive.integral_gain
    return {ERROR: kp * kv + ki, RATE: kv, SUM: kp * ki, ACCELERATION: drive.inertia_feedforward}


def drive_quantities(law: Law, kind: AxisKind, stated: Drive | None) -> Quantities:
    """Gains of a law with an integral; which of them only appear together; and whether they are as stated."""
    found, effort, length = Quantities(), kind.effort_unit, kind.length_unit
    units = {"kp": f"{effort}/{length}", "kv": f"{effort}*s/{length}", "ki": f"{effort}/({length}*s)"}
    every: dict[str, tuple[Callable[[Values], float], str]] = {
        "velocity_gain": (lambda v: v[RATE] + v[SPEED] + _late(v) * v[ERROR], units["kv"]),
        "inertia_feedforward": (lambda v: v[ACCELERATION] + v.get(BENT, 0.0), kind.inertia_unit),
        "kp": (lambda v: v[ERROR], units["kp"]),
        "ki": (lambda v: v[SUM], units["ki"]),
        "dead_time": (lambda v: law.reading.late * law.period - v[LATE], "s"),
    }
    found.parameters = {name: law.parameter(*one) for name, one in every.items()}
    separate = _separate(law, units)
    withheld = -(law.values[SPEED] + _late(law.values) * law.values[ERROR]) / law.values[RATE]
    if separate:
        found.parameters = {**separate, **{k: one for k, one in found.parameters.items() if k not in separate}}
    elif withheld > PARTIAL:
        found.parameters["velocity_gain"] = law.parameter(lambda v: v[RATE], units["kv"])
        found.refused["position_gain"] = "the integral is of the position alone, as in a PID controller: see kp, kv, ki"
    else:
        found.inseparable = {name: found.parameters[of] for name, of in COMBINED.items()}
        found.refused["position_gain"] = "it and integral_gain/velocity_gain may be exchanged for each other"
        found.advice.append(ADVICE)
    found.parameters["kv"] = found.parameters["velocity_gain"]
    if law.limit is None:
        found.refused["force_limit"] = "the torque does not stay at its largest value"
    else:
        found.parameters["force_limit"] = replace(law.limit, unit=effort)
    found.stated = {} if stated is None else _compared(found, stated)
    return found


def _compared(found: Quantities, stated: Drive) -> dict[str, Agreement]:
    """Gains, or what is known of them together, next to what a rig states.

    Between two ticks of period T the integral of u goes on by u*T, and laws of drives differ by half of that.
    """
    law, tick = by_stated(stated), 0.5 * stated.control_period
    known = {**dict(stated), "kp": law[ERROR], "ki": law[SUM]}
    between = {"velocity_gain": stated.integral_gain * tick, "kp": law[SUM] * tick}
    names = {name: name for name in GAINS if name in found.parameters}
    names |= {name: COMBINED[name] for name in found.inseparable}
    result = dict[str, Agreement]()
    for name, of in names.items():
        one = found.parameters[of]
        within = CONTRADICTS * one.half_width + between.get(of, 0.0)
        result[name] = Agreement(known[of], one, abs(known[of] - one.value) <= within)
    return result


def _late(values: Values) -> float:
    """By how much the reference would be late if all that r shows were that - s."""
    return -values[GOAL] / values[SUM]


def _gains(values: Values, side: float) -> tuple[float, ...]:
    """K_p, K_v, K_i, f, the lag of the speed - s - and K_v/K_i of a cascade whose r shows K_i, one of two solutions.

    With c, d, r the coefficients of e, its integral and r, and p = f*K_v that of its slope and v together, 1 - f is a
    root of (p*d - c*r)*x**2 + (c*r - r**2)*x + r**2.
    """
    c, d, r, p = values[ERROR], values[SUM], values[GOAL], values[RATE] + values[SPEED]
    a, b = p * d - c * r, c * r - r * r
    x = (-b + side * np.sqrt(max(b * b - 4.0 * a * r * r, 0.0))) / (2.0 * a)
    integral = -r / x
    speed = (c - integral) * integral / d
    return d / integral, speed, integral, 1.0 - x, (speed - values[RATE]) / integral, speed / integral


def _separate(law: Law, units: Mapping[str, str]) -> dict[str, Parameter]:
    """The gains of a cascade whose r shows K_i: of the solutions whose speed is late by nothing to some samples.

    A reference that is late by d looks like a speed that is late by -d. Where both are possible, intervals cover both.
    """
    if abs(_late(law.values)) <= TIMING * law.period:
        return {}
    names = {"position_gain": "1/s", "velocity_gain": units["kv"], "integral_gain": units["kp"]}
    names |= {"velocity_feedforward": "dimensionless", "lag": "s", "reset_time": "s"}
    each = [
        {
            name: law.parameter(lambda v, k=k, one=one: _gains(v, one)[k], unit)
            for k, (name, unit) in enumerate(names.items())
        }
        for one in (1.0, -1.0)
    ]
    possible = [one for one in each if one["lag"].ci95[1] > 0.0 and one["lag"].ci95[0] < TIMING * law.period]
    possible.sort(key=lambda one: abs(one["lag"].value))
    if not possible:
        return {}
    first, *others = possible
    first = {name: value.reaching(other[name].value) for name, value in first.items() for other in others} or first
    wide = first["integral_gain"].half_width > DETERMINED * first["integral_gain"].value
    return {} if wide else {name: value for name, value in first.items() if name != "lag"}
