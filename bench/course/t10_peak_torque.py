"""Task 10: torque over speed of the fastest run-up, against the datasheet's peak curve."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.course.corner import STILL_RISING, Decline, decline
from bench.course.result import Chart, Curve, Number, Panel, Task
from bench.course.run import Run
from bench.course.sources import Sources
from bench.errors import UndeterminedError
from bench.rig.limits import peak_curve
from bench.rig.rig import Rig

KEY, TITLE = "10", "Peak torque over speed"

RPM = 60.0 / (2.0 * math.pi)
#: The course drops samples of less torque - N*m - and starts at the first above 3.0 N*m, this share of the lab
#: motor's peak.
LEAST_TORQUE, FULL_SHARE = 0.2, 3.0 / 3.5
#: Speeds of the table - rpm, and samples that belong to one: within this of it - rad/s.
SPEEDS, HALF_BIN = (1500.0, 2000.0, 2500.0, 3000.0, 3500.0, 4000.0, 4500.0), 5.0


def run_up(run: Run, rig: Rig) -> tuple[Array, Array, Array]:
    """Speed - rad/s, torque - N*m - and current - A - from the first full torque on, samples with M < 0.2 N*m dropped.

    Raises:
        UndeterminedError: the torque never comes near its peak.
    """
    kept = run.torque >= LEAST_TORQUE
    kept[: int(np.argmax(_full(run, rig)))] = False
    return run.velocity[kept], run.torque[kept], run.current[kept]


def _full(run: Run, rig: Rig) -> NDArray[np.bool_]:
    """Samples of full torque, more than 3.0 N*m with the lab's motor."""
    least = FULL_SHARE * (rig.motor.peak_torque or 0.0)
    full = run.torque > least
    if not full.any():
        reason = f"the torque never exceeds {least:.3g} N*m, it reaches {float(run.torque.max()):.3g} N*m"
        raise UndeterminedError("peak torque over speed", reason, "a run-up with the motor's full torque, forward")
    return full


def datasheet_curve(rig: Rig, mains: float) -> tuple[Array, Array]:
    """Corners of the peak curve at a mains voltage - V: speed - rad/s, torque - N*m."""
    curve = peak_curve(rig.motor, mains, rig.source)
    speed = np.array([0.0, curve.corner_speed, curve.no_load_speed])
    return speed, (rig.motor.peak_torque or 0.0) * curve.share(speed)


def fall(run: Run, rig: Rig) -> Decline:
    """Corner of the run-up and how the current falls beyond it.

    Raises:
        UndeterminedError: the torque never comes near its peak, or the current does not fall to half.
    """
    start = int(np.argmax(_full(run, rig)))
    return decline(run.velocity[start:], run.current[start:], run.sample_period)


def table(velocity: Array, torque: Array, corners: Array) -> list[tuple[float, float, float]]:
    """Speed - rad/s, M_max measured - N*m - and that of the datasheet at SPEEDS.

    The measured one is the median of the samples within HALF_BIN of the speed, on the way up; NaN where there is none.

    Args:
        velocity, torque: (n,) of the run-up.
        corners: (2, 3) speeds and torques of the datasheet's curve.
    """
    up = slice(0, int(np.argmax(velocity)) + 1)
    rows = []
    for speed in np.array(SPEEDS) / RPM:
        near = np.abs(velocity[up] - speed) <= HALF_BIN
        measured = float(np.median(torque[up][near])) if near.any() else math.nan
        rows.append((float(speed), measured, float(np.interp(speed, *corners))))
    return rows


def task(run: Run, rig: Rig, sources: Sources, mains: float = 230.0) -> Task:
    """Draw the measured torque over the speed beside the datasheet's curve, and tell both at seven speeds."""
    velocity, torque, _ = run_up(run, rig)
    limit, allowed = datasheet_curve(rig, mains)
    found = fall(run, rig)
    rows = table(velocity, torque, np.stack([limit, allowed]))
    curves = (
        Curve(velocity * RPM, torque, "measured", "dots"),
        Curve(limit * RPM, allowed, f"datasheet, {mains:g} V", "dashes"),
        Curve(np.array([found.corner]) * RPM, np.interp([found.corner], velocity, torque), "corner", "bold dots"),
    )
    peak = sources("motor", "peak_torque")
    numbers = [
        Number("peak torque", float(torque.max()), "N·m", rig.motor.peak_torque if run.truth else None),
        Number("measured corner", found.corner * RPM, "rpm", run.true("corner_speed", RPM)),
        Number("datasheet's corner", float(limit[1]) * RPM, "rpm", source=sources("motor", "peak_curves")),
    ]
    for speed, measured, sheet in rows:
        name = f"M_max at {speed * RPM:.0f} rpm"
        if math.isfinite(measured):
            numbers.append(Number(name, measured, "N·m"))
        numbers.append(Number(f"{name}, datasheet", sheet, "N·m", source=peak))
    findings = (
        f"The torque starts to decline at {found.corner * RPM:.0f} rpm, {(found.corner - limit[1]) * RPM:+.0f} "
        "rpm from "
        "the datasheet's corner; task 11 says why. The corner is found by least squares on the current from its top to "
        "half of it: constant, then falling in proportion to speed with a lag, as the motor's circuit has it.",
        *_tail_findings(velocity, torque, found),
        *_missing_findings(rows),
    )
    chart = Chart("Task 10: peak torque", (Panel("speed n / rpm", "torque M / (N·m)", curves),))
    return Task(KEY, TITLE, findings, tuple(numbers), (chart,))


def _tail_findings(velocity: Array, torque: Array, found: Decline) -> tuple[str, ...]:
    """What ends the run before the no-load speed: the drive's set speed, which the axis then keeps."""
    top = float(velocity.max())
    if top > 0.99 * found.no_load:
        return ()
    tail = velocity > STILL_RISING * top
    return (
        f"The tail above {STILL_RISING * top * RPM:.0f} rpm is not the motor's limit. The drive was set to about "
        f"{top * RPM:.0f} rpm: as the axis gets there its speed control takes the torque back, to "
        f"{float(torque[tail].min()):.2g} N·m, where the winding would still give it up to "
        f"{found.no_load * RPM:.0f} rpm.",
    )


def _missing_findings(rows: list[tuple[float, float, float]]) -> tuple[str, ...]:
    missing = [f"{speed * RPM:.0f}" for speed, measured, _ in rows if not math.isfinite(measured)]
    return (f"At {', '.join(missing)} rpm there is no sample: the run-up does not get there.",) if missing else ()
