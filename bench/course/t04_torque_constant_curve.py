"""Task 4: kT(Iq) = a*Iq**2 + b*Iq + c from three conditions: flat at zero, and both points of the datasheet."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.course.recordings import LabRecordings
from bench.course.result import DoneTask, Number, chart, curve, panel
from bench.course.t03_torque_constants import datasheet, torque_constants
from bench.rig.rig import Rig

KEY, TITLE = "4", "Torque constant over current"


def coefficients(rig: Rig) -> Array:
    """a - N*m/A**3, b - N*m/A**2, c - N*m/A of three linear equations.

    kT'(0) = 0, which is b = 0 and leaves two: kT(I0) = M0/I0, kT(Imax) = Mmax/Imax.

    Raises:
        InputError: the motor lacks one of the four values.
    """
    met = torque_constants(rig)
    low, high = currents(rig)
    a, c = np.linalg.solve(np.array([[low**2, 1.0], [high**2, 1.0]]), np.array(met))
    return np.array([a, 0.0, c])


def currents(rig: Rig) -> Array:
    """I0 and Imax - A."""
    return np.array([rig.motor.continuous_stall_current or 0.0, rig.motor.peak_current or 0.0])


def task(recordings: LabRecordings) -> DoneTask:
    """Solve for the coefficients, check and draw the curve."""
    rig, source = recordings.rig, datasheet(recordings.sources)
    a, b, c = coefficients(rig)
    points, given = currents(rig), np.array(torque_constants(rig))
    current = np.linspace(0.0, points[1], 400)
    fitted = a * current**2 + b * current + c
    off = np.abs(a * points**2 + b * points + c - given)
    falls = "falls monotonically" if np.all(np.diff(fitted[1:]) < 0.0) else "does not fall everywhere"
    findings = (
        f"Checked: slope at zero {b:g} N·m/A²; {falls} "
        f"up to {points[1]:g} A; both points of the datasheet met within {off.max():.1g} N·m/A."
    )
    numbers = tuple(
        Number(name, float(value), unit, source=source)
        for name, value, unit in zip("abc", (a, b, c), ("N·m/A³", "N·m/A²", "N·m/A"), strict=True)
    )
    axes = panel(
        "current Iq / A",
        "torque constant kT / (N·m/A)",
        curve(current, fitted, "a·Iq² + b·Iq + c"),
        curve(points, given, "datasheet: stall and peak", "large dots"),
    )
    return DoneTask(KEY, TITLE, (findings,), numbers, (chart("kT(Iq)", axes),))
