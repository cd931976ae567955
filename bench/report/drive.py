"""What a drive is asked for and given: a motion to record, how well it tracks, and the operating range of its motor."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.axis_kind import AxisKind
from bench.errors import InputError
from bench.export.feedforward import Tracking
from bench.export.plan import PlannedMotion
from bench.names import readable, words
from bench.report import document as doc
from bench.report.numbers import number, share, unit_text
from bench.report.parts import origin, values_table
from bench.rig.limits import OperatingRange, Reserve, reserve
from bench.rig.rig import Rig
from bench.trace.trace import Trace


def plan_table(best: PlannedMotion) -> doc.Table:
    """What a motion will determine, and how well."""
    title = f"{best.profile}, {best.motion.time[-1]:.3g} s: what it will determine, and how well"
    rows = (
        (words(name), number(found.value), number(found.std_error, digits=2), unit_text(found.unit))
        for name, found in best.expected.items()
    )
    return doc.table(title, ("quantity", "expected>", "standard error>", "unit"), rows)


def others_line(found: list[PlannedMotion]) -> str:
    """How well all profiles determine the same, in a line."""
    others = [f"{each.profile} {'nothing' if each.reason else share(each.worst)}" for each in found]
    return f"largest standard error over its value: {', '.join(others)}"


def tracking_table(title: str, before: Tracking, after: Tracking, kind: AxisKind) -> doc.Table:
    """RMS tracking errors before, without what is fed forward, and after, with it; `title`: axis and motion."""
    rows = []
    for name, unit in (("position", kind.length_unit), ("velocity", kind.speed_unit)):
        was, now = getattr(before, name), getattr(after, name)
        less = number(was / now, digits=3) if now > 0.0 else ""
        rows.append((name, number(was), number(now), less, unit_text(unit)))
    headings = ("RMS tracking error", "as the rig's drive is>", "with the tables>", "times less>", "unit")
    return doc.table(title, headings, rows)


#: Mains voltage that a motor is held to which states no curve - V - and revolutions per minute of 1 rad/s.
MAINS, RPM = 230.0, 30.0 / math.pi
COLD_FINDING = (
    "A cold winding has more voltage in reserve at speed, until it has warmed: do not plan with its peak reserve. It "
    "changes nothing where the magnets limit, nor for heat."
)
WITHIN = "Nothing: the motor can follow this motion."
BEYOND = "Record the motion with less speed or acceleration, and run the same command for it."


@dataclass(frozen=True)
class InRange:
    """A motion in its motor's range: in sentences, reserves and effective values with their units, and as a diagram."""

    findings: tuple[str, ...]
    numbers: dict[str, tuple[float, str]]
    chart: doc.Chart


def limits(trace: Trace, rig: Rig) -> doc.Document:
    """The document of a recording's reserve to the motor's limits, at every mains voltage the rig has a curve for.

    Raises:
        InputError: a linear axis, no velocity, no torque in N*m to be had, or no limits in the rig.
    """
    if not rig.axis_kind.turns:
        raise InputError(rig.source, f"found a {rig.kind} axis", "allowed: a rotary one, whose motor has peak_curves")
    effort, unit = rig.effort(trace)
    if unit != "N*m":
        raise InputError(rig.source, f"gives the effort in {unit}", "the operating range needs it in N*m")
    name = readable(trace.origin).rpartition("/")[2]
    found = in_range(rig, trace["velocity"], np.asarray(effort), name)
    reserves = {key: value for key, value in found.numbers.items() if "reserve" in key}
    least = min(value for value, _ in reserves.values())
    values = ((name, value, unit) for name, (value, unit) in found.numbers.items())
    blocks = (values_table("Reserves and effective values", values, 4), found.chart)
    return doc.Document(
        title=name,
        subject=f"Operating range of {rig.name}: {name}",
        verdict=f"The motion {'stays within' if least >= 0.0 else 'exceeds'} the motor's limits.",
        tone="sure" if least >= 0.0 else "refused",
        answers={
            "How large is the reserve?": "; ".join(f"{name} {number(*value, 3)}" for name, value in reserves.items())
            + ".",
            "How sure?": "The limits are the datasheet's values, without tolerances of motor and supply.",
            "What next?": WITHIN if least >= 0.0 else BEYOND,
        },
        sections=(
            doc.section("findings", "Reserve", doc.points(found.findings)),
            doc.section("range", "Operating range", *blocks),
        ),
        origin=origin(None),
        pictures=(doc.Picture(name="limits", title="", rows=((found.chart,),)),),
    )


def in_range(rig: Rig, speed: Array, torque: Array, what: str) -> InRange:
    """A motion of speed (n,) - rad/s - and torque (n,) - N*m - in the range at every mains voltage, and its reserve.

    Raises:
        InputError: the motor lacks its torques or curves.
    """
    mains = [curve.mains_voltage for curve in rig.motor.peak_curves] or [MAINS]
    ranges = {f"{voltage:g} V": OperatingRange.of(rig.motor, voltage, rig.source) for voltage in mains}
    warm = {volts: reserve(limit, speed, torque) for volts, limit in ranges.items()}
    of_peak: dict[float, list[str]] = {}  # where voltage does not limit, one reserve is that of all
    for volts, of in warm.items():
        of_peak.setdefault(of.peak, []).append(volts)
    panels, in_legend = [], set()  # one legend serves all panels
    for volts, limit in ranges.items():
        curves = _curves(speed, torque, warm[volts], limit)
        with suppress(InputError):  # the motor has no circuit
            cold = limit.cold(rig.motor, rig.source)
            of_peak.setdefault(reserve(cold, speed, torque).peak, []).append(f"{volts} cold")
            at = np.linspace(0.0, cold.curve.no_load_speed, 300)
            curves.append(doc.series("peak, winding at 20 °C", "dotted", "ink", at * RPM, cold.peak(at)))
        coloured = (
            one.model_copy(update={"colour": colour, "name": "" if one.name in in_legend else one.name})
            for one, colour in zip(curves, doc.COLOURS, strict=False)
        )
        label = f"torque M at {volts} / (N·m)"
        panels.append(doc.Panel(x_label="speed |n| / rpm", y_label=label, series=tuple(coloured)))
        in_legend |= {one.name for one in curves}
    left = next(iter(warm.values()))
    findings = [
        f"At {', '.join(names)}: {_peak_finding(warm[names[0]], speed, torque)}"
        for names in of_peak.values()
        if names[0] in warm
    ]
    findings += [f"At {volts}: {_thermal_finding(of)}" for volts, of in warm.items()]
    findings.append(_heat_finding(left, next(iter(ranges.values()))))
    findings += [COLD_FINDING] if any("cold" in name for names in of_peak.values() for name in names) else []
    numbers = {f"peak reserve, {', '.join(names)}": (peak, "N·m") for peak, names in of_peak.items()}
    numbers |= {f"thermal reserve, {volts}": (of.thermal, "A") for volts, of in warm.items()}
    numbers |= {"RMS torque": (left.rms_torque, "N·m"), "RMS current": (left.rms_current, "A")}
    title, alternative = f"Operating range: {what}", "Torque over speed, and the limits, at each mains voltage."
    return InRange(tuple(findings), numbers, doc.Chart(title=title, alternative=alternative, panels=tuple(panels)))


def _peak_finding(left: Reserve, speed: Array, torque: Array) -> str:
    braking = "braking" if speed[left.at] * torque[left.at] < 0.0 else "driving"
    beyond = f"; {share(left.beyond)} of the samples lie beyond the limit" if left.beyond else ""
    return (
        f"least reserve to the peak torque {number(left.peak, 'N·m', 3)} ({share(left.peak_share)}) at "
        f"{number(round(speed[left.at] * RPM), 'rpm')}, {braking}{beyond}."
    )


def _thermal_finding(left: Reserve) -> str:
    hot = ", the motor would overheat if this repeats" if left.thermal < 0.0 else ""
    return (
        f"RMS current {left.rms_current:.3g} A at {left.mean_speed * RPM:.0f} rpm on average has "
        f"{number(left.thermal, 'A', 3)} ({share(left.thermal_share)}) in reserve to the continuous "
        f"{left.continuous_current:.3g} A{hot}."
    )


def _heat_finding(left: Reserve, limit: OperatingRange) -> str:
    """Why heat goes by current and not by torque."""
    by_torque = left.rms_torque / float(limit.torque_constant(np.asarray(left.continuous_current)))
    return (
        f"Heat goes with the square of the current. The RMS torque of {left.rms_torque:.3g} N·m over the torque "
        f"constant at continuous current would give {by_torque:.3g} A; the iron saturates at the peaks, so they take "
        f"more: {left.rms_current:.3g} A."
    )


def _curves(speed: Array, torque: Array, left: Reserve, limit: OperatingRange) -> list[doc.Series]:
    """The samples, those that brake below the axis; the point that heats as all; the least reserve; and the limits."""
    effective = np.atleast_1d(limit.torque_constant.torque(np.asarray(left.rms_current)))
    power = speed * torque
    side = -1.0 if power[left.at] < 0.0 else 1.0
    ends = side * (np.abs(torque[left.at]) + np.array([[0.0], [left.peak]]))
    at = np.abs(speed[[left.at]]) * RPM
    heat, label = np.array([left.mean_speed * RPM]), f"least reserve to the peak, {left.peak:.3g} N·m"
    along = np.linspace(0.0, limit.curve.no_load_speed, 300)
    braking = limit.available(along, np.full_like(along, -1.0))
    return [
        doc.series("motion, braking below 0", "dots", "ink", np.abs(speed) * RPM, np.sign(power) * np.abs(torque)),
        doc.series("RMS current at mean speed", "large dots", "ink", heat, effective),
        doc.series(label, "large dots", "ink", at, ends[0], (ends[0], ends[1])),
        doc.series("peak", "line", "ink", along * RPM, limit.peak(along)),
        doc.series("continuous", "dashes", "ink", along * RPM, limit.continuous(along)),
        doc.series("peak braking", "dotted", "ink", along * RPM, -braking),
    ]
