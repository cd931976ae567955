"""Task 10: torque over speed of the fastest run-up, against the datasheet's peak curve."""

from __future__ import annotations

import math

import numpy as np

from bench.arrays import Array
from bench.errors import UndeterminedError
from bench.lab.corner import corner_speed
from bench.lab.result import Chart, Curve, Number, Panel, Task
from bench.lab.run import Run
from bench.rig.limits import peak_curve
from bench.rig.rig import Rig

KEY, TITLE = "10", "Peak torque over speed"

RPM = 60.0 / (2.0 * math.pi)
#: The course drops samples of less torque, and starts at the first of more - N*m.
LEAST_TORQUE, FULL_TORQUE = 0.2, 3.0


def run_up(run: Run) -> tuple[Array, Array, Array]:
    """Speed - rad/s, torque - N*m - and current - A - from the first M > 3.0 N*m on, samples with M < 0.2 N*m dropped.

    Raises:
        UndeterminedError: the torque never exceeds 3.0 N*m.
    """
    kept = run.torque >= LEAST_TORQUE
    velocity, torque, current = run.velocity[kept], run.torque[kept], run.current[kept]
    full = torque > FULL_TORQUE
    if not full.any():
        reason = f"the torque never exceeds {FULL_TORQUE:g} N*m"
        raise UndeterminedError("peak torque over speed", reason, "a run-up with the motor's full torque")
    start = int(np.argmax(full))
    return velocity[start:], torque[start:], current[start:]


def datasheet_curve(rig: Rig, mains: float) -> tuple[Array, Array]:
    """Corners of the peak curve at a mains voltage - V: speed - rad/s, torque - N*m."""
    curve = peak_curve(rig.motor, mains, rig.source)
    speed = np.array([0.0, curve.corner_speed, curve.no_load_speed])
    return speed, (rig.motor.peak_torque or 0.0) * curve.share(speed)


def task(run: Run, rig: Rig, mains: float = 230.0) -> Task:
    """Draw the measured torque over the speed beside the datasheet's curve."""
    velocity, torque, current = run_up(run)
    limit, allowed = datasheet_curve(rig, mains)
    corner = corner_speed(velocity, current)
    curves = (
        Curve(velocity * RPM, torque, "measured", "dots"),
        Curve(limit * RPM, allowed, f"datasheet, {mains:g} V", "dashes"),
    )
    return Task(
        KEY,
        TITLE,
        (
            f"The measured corner lies at {corner * RPM:.0f} rpm, {(corner - limit[1]) * RPM:+.0f} rpm from the "
            "datasheet's; task 11 says why. The corner is where the line through the falling current, from 90 to "
            "50 % of its top, meets the top.",
        ),
        (
            Number("peak torque", float(torque.max()), "N·m", rig.motor.peak_torque if run.truth else None),
            Number("measured corner", corner * RPM, "rpm", run.true("corner_speed", RPM)),
            Number("datasheet's corner", float(limit[1]) * RPM, "rpm"),
        ),
        (Chart("Task 10: peak torque", (Panel("speed n / rpm", "torque M / (N·m)", curves),)),),
    )
