"""The operating range: a recording in the speed-torque diagram, and the reserve that it leaves."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array, rms
from bench.lab.result import Chart, Curve, Number, Panel, Task
from bench.lab.t10_peak_torque import RPM
from bench.rig.limits import OperatingRange, reserve
from bench.rig.rig import Rig

KEY, TITLE = "range", "Operating range"


def task(rig: Rig, speed: Array, torque: Array, what: str) -> Task:
    """Draw a motion into the range at every mains voltage of the motor, and state its reserve.

    Args:
        rig: its motor.
        speed, torque: of the motion, (n,) - rad/s, N*m.
        what: it is, for the title.

    Raises:
        InputError: the motor lacks its torques or curves.
    """
    ranges = [
        OperatingRange.of(rig.motor, voltage, rig.source)
        for voltage in [curve.mains_voltage for curve in rig.motor.peak_curves] or [230.0]
    ]
    says, numbers, limits = [], [], []
    for limit in ranges:
        volts = f"{limit.curve.mains_voltage:g} V"
        left = reserve(limit, speed, torque)
        beyond = f"; {left.beyond:.1%} of the samples lie beyond the limit" if left.beyond else ""
        says.append(
            f"At {volts}: least reserve to the peak torque {left.peak:.3g} N·m ({left.peak_share:.0%}) at "
            f"{speed[left.at] * RPM:.0f} rpm{beyond}. RMS torque {left.rms_torque:.3g} N·m at "
            f"{left.mean_speed * RPM:.0f} rpm on average leaves {left.thermal:.3g} N·m ({left.thermal_share:.0%}) to "
            f"the continuous torque{', the motor would overheat if this repeats' if left.thermal < 0.0 else ''}."
        )
        numbers += [
            Number(f"peak reserve, {volts}", left.peak, "N·m"),
            Number(f"thermal reserve, {volts}", left.thermal, "N·m"),
        ]
        limits += _limit_curves(limit, volts)
    numbers.append(Number("RMS torque", rms(torque), "N·m"))
    motion = Curve(np.abs(speed) * RPM, np.sign(speed * torque) * np.abs(torque), "motion", "dots")
    panel = Panel("speed |n| / rpm", "torque M in the direction of motion / (N·m)", (motion, *limits))
    return Task(KEY, f"{TITLE}: {what}", tuple(says), tuple(numbers), (Chart(f"Operating range: {what}", (panel,)),))


def _limit_curves(limit: OperatingRange, volts: str) -> list[Curve]:
    speed = np.linspace(0.0, limit.curve.no_load_speed, 300)
    return [
        Curve(speed * RPM, limit.peak(speed), f"peak, {volts}"),
        Curve(speed * RPM, limit.continuous(speed), f"continuous, {volts}", "dashes"),
    ]
