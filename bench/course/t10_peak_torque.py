"""Task 10: torque over speed of the fastest run-up, against the datasheet's peak curve."""

from __future__ import annotations

import math

import numpy as np

from bench.arrays import Array
from bench.course.axis import MAINS, RPM
from bench.course.corner import STILL_RISING, Decline, decline
from bench.course.recordings import LabRecordings, LabRun
from bench.course.result import DoneTask, Number, chart, curve, panel
from bench.errors import UndeterminedError
from bench.rig.limits import peak_curve
from bench.rig.rig import Rig

KEY, TITLE = "10", "Peak torque over speed"

#: The course drops samples of less torque - N*m - and starts at the first above 3.0 N*m, this share of the lab
#: motor's peak.
LEAST_TORQUE, FULL_SHARE = 0.2, 3.0 / 3.5
#: Speeds of the table - rpm, and samples that belong to one: within this of it - rad/s.
SPEEDS, HALF_BIN = (1500.0, 2000.0, 2500.0, 3000.0, 3500.0, 4000.0, 4500.0), 5.0


def start(run: LabRun, rig: Rig) -> int:
    """First sample of full torque, more than 3.0 N*m with the lab's motor.

    Raises:
        UndeterminedError: the torque never comes near its peak.
    """
    least = FULL_SHARE * (rig.motor.peak_torque or 0.0)
    full = run.torque > least
    if not full.any():
        reason = f"the torque never exceeds {least:.3g} N*m, it reaches {float(run.torque.max()):.3g} N*m"
        raise UndeterminedError("peak torque over speed", reason, "a run-up with the motor's full torque, forward")
    return int(np.argmax(full))


def run_up(run: LabRun, rig: Rig) -> LabRun:
    """Samples from the first full torque on, those with M < 0.2 N*m dropped; raises as `start`."""
    return run.at((run.torque >= LEAST_TORQUE) & (np.arange(run.torque.size) >= start(run, rig)))


def fall(run: LabRun, rig: Rig) -> Decline:
    """Corner of the run-up and how the current falls beyond it.

    Raises:
        UndeterminedError: the torque never comes near its peak, or the current does not fall to half.
    """
    first = start(run, rig)
    return decline(run.velocity[first:], run.current[first:], run.sample_period)


def datasheet_curve(rig: Rig) -> tuple[Array, Array]:
    """Corners of the peak curve at MAINS: speed - rad/s, torque - N*m."""
    curve = peak_curve(rig.motor, MAINS, rig.source)
    speed = np.array([0.0, curve.corner_speed, curve.no_load_speed])
    return speed, (rig.motor.peak_torque or 0.0) * curve.share(speed)


def measured_at_speeds(velocity: Array, torque: Array) -> Array:
    """M_max at SPEEDS - N*m, the median of the samples within HALF_BIN on the way up; NaN where there is none.

    Args:
        velocity, torque: (n,) of the run-up - rad/s, N*m.
    """
    up = slice(0, int(np.argmax(velocity)) + 1)
    near = (np.abs(velocity[up] - speed / RPM) <= HALF_BIN for speed in SPEEDS)
    return np.array([np.median(torque[up][samples]) if samples.any() else math.nan for samples in near])


def task(recordings: LabRecordings) -> DoneTask:
    """Draw the measured torque over the speed beside the datasheet's curve, and tell both at seven speeds."""
    run, rig, sources = recordings.fastest, recordings.rig, recordings.sources
    kept = run_up(run, rig)
    speed, torque = kept.velocity * RPM, kept.torque
    limit, allowed = datasheet_curve(rig)
    found = fall(run, rig)
    corner, corner_of_datasheet = found.corner * RPM, float(limit[1]) * RPM
    measured = measured_at_speeds(kept.velocity, torque)
    numbers = [
        Number("peak torque", float(torque.max()), "N·m", rig.motor.peak_torque if run.truth else None),
        Number("measured corner", corner, "rpm", run.true("corner_speed", RPM)),
        Number("datasheet's corner", corner_of_datasheet, "rpm", source=sources("motor", "peak_curves")),
    ]
    for at, value, sheet in zip(SPEEDS, measured, np.interp(SPEEDS, limit * RPM, allowed), strict=True):
        name = f"M_max at {at:.0f} rpm"
        if math.isfinite(value):
            numbers.append(Number(name, float(value), "N·m"))
        numbers.append(Number(f"{name}, datasheet", float(sheet), "N·m", source=sources("motor", "peak_torque")))
    findings = (
        f"The torque starts to decline at {corner:.0f} rpm, {corner - corner_of_datasheet:+.0f} rpm from "
        "the datasheet's corner; task 11 says why. The corner is found by least squares on the current from its top to "
        "half of it: constant, then falling in proportion to speed with a lag, as the motor's circuit has it.",
        *_tail_findings(kept, found),
        *_missing_findings(measured),
    )
    axes = panel(
        "speed n / rpm",
        "torque M / (N·m)",
        curve(speed, torque, "measured", "dots"),
        curve(limit * RPM, allowed, f"datasheet, {MAINS:g} V", "dashes"),
        curve(np.array([corner]), np.interp([corner], speed, torque), "corner", "large dots"),
    )
    return DoneTask(KEY, TITLE, findings, tuple(numbers), (chart("Task 10: peak torque", axes),))


def _tail_findings(kept: LabRun, found: Decline) -> tuple[str, ...]:
    """What ends the run before the no-load speed: the drive's set speed, which the axis then keeps."""
    top = float(kept.velocity.max())
    if top > 0.99 * found.no_load:
        return ()
    tail = kept.velocity > STILL_RISING * top
    return (
        f"The tail above {STILL_RISING * top * RPM:.0f} rpm is not the motor's limit. The drive was set to about "
        f"{top * RPM:.0f} rpm: as the axis gets there its speed control takes the torque back, to "
        f"{float(kept.torque[tail].min()):.2g} N·m, where the winding would still give it up to "
        f"{found.no_load * RPM:.0f} rpm.",
    )


def _missing_findings(measured: Array) -> tuple[str, ...]:
    missing = [f"{speed:.0f}" for speed, value in zip(SPEEDS, measured, strict=True) if not math.isfinite(value)]
    return (f"At {', '.join(missing)} rpm there is no sample: the run-up does not get there.",) if missing else ()
