"""The operating range: a recording in the speed-torque diagram, and the reserve that it leaves."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bench.arrays import Array
from bench.course.axis import MAINS, RPM
from bench.course.recordings import LabRecordings
from bench.course.result import DoneTask, Number, chart, curve, panel
from bench.errors import InputError
from bench.report.document import Series
from bench.rig.limits import OperatingRange, Reserve, reserve
from bench.rig.rig import Rig
from bench.trace.trace import Trace

KEY, TITLE = "range", "Operating range"


def task(recordings: LabRecordings) -> DoneTask:
    """The recording with friction."""
    run = recordings.with_friction
    return in_range(recordings.rig, run.velocity, run.torque, "recording with friction")


def trace_in_range(trace: Trace, rig: Rig) -> DoneTask:
    """Any recording's reserve to the motor's limits, at every mains voltage the rig has a curve for.

    Raises:
        InputError: a linear axis, no velocity, no torque in N*m to be had, or no limits in the rig.
    """
    if not rig.axis_kind.turns:
        raise InputError(rig.source, f"found a {rig.kind} axis", "allowed: a rotary one, whose motor has peak_curves")
    effort, unit = rig.effort(trace)
    if unit != "N*m":
        raise InputError(rig.source, f"gives the effort in {unit}", "the operating range needs it in N*m")
    return in_range(rig, trace["velocity"], np.asarray(effort), Path(trace.origin).name)


def in_range(rig: Rig, speed: Array, torque: Array, what: str) -> DoneTask:
    """Draw a motion into the range at every mains voltage of the motor, and state its reserve.

    Args:
        rig: its motor.
        speed, torque: of the motion, (n,) - rad/s, N*m.
        what: it is, for the title.

    Raises:
        InputError: the motor lacks its torques or curves.
    """
    mains = [curve.mains_voltage for curve in rig.motor.peak_curves] or [MAINS]
    ranges = [OperatingRange.of(rig.motor, voltage, rig.source) for voltage in mains]
    findings, numbers, curves = [], [], []
    for limit in ranges:
        volts = f"{limit.curve.mains_voltage:g} V"
        left = reserve(limit, speed, torque)
        findings.append(f"At {volts}: {_peak_finding(left, speed, torque)} {_thermal_finding(left)}")
        numbers.append(Number(f"peak reserve, {volts}", left.peak, "N·m"))
        numbers.append(Number(f"thermal reserve, {volts}", left.thermal, "A"))
        curves += _limit_curves(limit, volts)
        cold = _cold(limit, rig)
        if cold is not None:
            numbers.append(Number(f"peak reserve, {volts}, cold", reserve(cold, speed, torque).peak, "N·m"))
            at = np.linspace(0.0, cold.curve.no_load_speed, 300)
            curves.append(curve(at * RPM, cold.peak(at), f"peak, {volts}, winding at 20 °C", "dotted"))
    left = reserve(ranges[0], speed, torque)
    findings.append(_heat_finding(left, ranges[0]))
    if any(number.name.endswith("cold") for number in numbers):
        findings.append(
            "A cold winding leaves more voltage at speed, until it has warmed: its peak reserve stands apart and is "
            "none to plan with. It changes nothing where the magnets limit, nor for heat."
        )
    numbers += [Number("RMS torque", left.rms_torque, "N·m"), Number("RMS current", left.rms_current, "A")]
    motion = _motion(speed, torque, left, ranges[0])
    axes = panel("speed |n| / rpm", "torque M in the direction of motion / (N·m)", *motion, *curves)
    drawn = chart(f"Operating range: {what}", axes)
    return DoneTask(KEY, f"{TITLE}: {what}", tuple(findings), tuple(numbers), (drawn,))


def _peak_finding(left: Reserve, speed: Array, torque: Array) -> str:
    braking = "braking" if speed[left.at] * torque[left.at] < 0.0 else "driving"
    beyond = f"; {left.beyond:.1%} of the samples lie beyond the limit" if left.beyond else ""
    return (
        f"least reserve to the peak torque {left.peak:.3g} N·m ({left.peak_share:.0%}) at "
        f"{speed[left.at] * RPM:.0f} rpm, {braking}{beyond}."
    )


def _thermal_finding(left: Reserve) -> str:
    hot = ", the motor would overheat if this repeats" if left.thermal < 0.0 else ""
    return (
        f"RMS current {left.rms_current:.3g} A at {left.mean_speed * RPM:.0f} rpm on average leaves "
        f"{left.thermal:.3g} A ({left.thermal_share:.0%}) to the continuous {left.continuous_current:.3g} A{hot}."
    )


def _heat_finding(left: Reserve, limit: OperatingRange) -> str:
    """Why heat goes by current and not by torque."""
    by_torque = left.rms_torque / float(limit.torque_constant(np.asarray(left.continuous_current)))
    return (
        f"Heat goes with the square of the current. The RMS torque of {left.rms_torque:.3g} N·m over the torque "
        f"constant at continuous current would say {by_torque:.3g} A; the iron saturates at the peaks, so they take "
        f"more: {left.rms_current:.3g} A."
    )


def _motion(speed: Array, torque: Array, left: Reserve, limit: OperatingRange) -> list[Series]:
    """The samples, those that brake below the axis; the point that heats as all; the least reserve to the limit."""
    effective = float(limit.torque_constant.torque(np.asarray(left.rms_current)))
    least = np.abs([speed[left.at], torque[left.at]])
    side = -1.0 if speed[left.at] * torque[left.at] < 0.0 else 1.0
    label = f"least reserve to the peak, {left.peak:.3g} N·m"
    return [
        curve(np.abs(speed) * RPM, np.sign(speed * torque) * np.abs(torque), "motion, braking below 0", "dots"),
        curve(np.array([left.mean_speed * RPM]), np.array([effective]), "RMS current at mean speed", "large dots"),
        curve(least[:1] * RPM, side * least[1:], label, "large dots", reach=np.array([side * left.peak])),
    ]


def _limit_curves(limit: OperatingRange, volts: str) -> list[Series]:
    speed = np.linspace(0.0, limit.curve.no_load_speed, 300)
    braking = limit.available(speed, np.full_like(speed, -1.0))
    return [
        curve(speed * RPM, limit.peak(speed), f"peak, {volts}"),
        curve(speed * RPM, limit.continuous(speed), f"continuous, {volts}", "dashes"),
        curve(speed * RPM, -braking, f"peak braking, {volts}", "dotted"),
    ]


def _cold(limit: OperatingRange, rig: Rig) -> OperatingRange | None:
    """None where the motor does not tell its circuit."""
    try:
        return limit.cold(rig.motor, rig.source)
    except InputError:
        return None
