"""Torque constants: kT = M/I from stall and peak (task 3), and the parabola through both, flat at zero (task 4)."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.course.recordings import LabRecordings
from bench.course.result import Number, TaskResult, chart, curve, panel
from bench.errors import InputError
from bench.rig.motor import DATASHEET
from bench.rig.rig import Rig


def datasheet_points(rig: Rig) -> tuple[Array, Array]:
    """I0 and Imax - A - and torque constants M0/I0 and Mmax/Imax - N*m/A; InputError where one value is missing."""
    values = [getattr(rig.motor, name) for name in DATASHEET]
    if None in values:
        raise InputError(f"{rig.source}: motor", "found no kT(Iq)", f"give {', '.join(DATASHEET)}")
    stall, stall_current, peak, peak_current = values
    return np.array([stall_current, peak_current]), np.array([stall / stall_current, peak / peak_current])


def coefficients(rig: Rig) -> Array:
    """a - N*m/A**3, b - N*m/A**2, c - N*m/A of kT(Iq) = a*Iq**2 + b*Iq + c by three linear equations.

    kT'(0) = 0, which is b = 0 and leaves two: kT(I0) = M0/I0, kT(Imax) = Mmax/Imax. Raises as `datasheet_points`.
    """
    current, constant = datasheet_points(rig)
    a, c = np.linalg.solve(np.stack([current**2, np.ones(2)], axis=1), constant)
    return np.array([a, 0.0, c])


def at_both_points(recordings: LabRecordings) -> TaskResult:
    """kT at stall and at peak."""
    stall, peak = datasheet_points(recordings.rig)[1].tolist()
    findings = (
        f"kT is {stall:.4g} N·m/A at stall and {peak:.4g} N·m/A at peak. It falls by "
        f"{1 - peak / stall:.0%}, as the stator's iron saturates: more current no longer raises the flux in "
        "proportion, so torque grows more slowly than current."
    )
    constants = {"kT from stall": stall, "kT from peak": peak}
    source = recordings.sources("motor", *DATASHEET)
    return TaskResult((findings,), tuple(Number(name, kt, "N·m/A", source=source) for name, kt in constants.items()))


def over_current(recordings: LabRecordings) -> TaskResult:
    """Solve for the coefficients, check and draw the curve."""
    points, given = datasheet_points(recordings.rig)
    a, b, c = coefficients(recordings.rig).tolist()
    current = np.linspace(0.0, points[1], 400)
    fitted = a * current**2 + b * current + c
    off = np.abs(a * points**2 + b * points + c - given)
    falls = "falls monotonically" if np.all(np.diff(fitted[1:]) < 0.0) else "does not fall everywhere"
    findings = (
        f"kT(Iq) = {a:.4g}·Iq² + {c:.4g} N·m/A with Iq in A. Slope at zero {b:g} N·m/A²; {falls} "
        f"up to {points[1]:g} A; both points of the datasheet met within {off.max():.1g} N·m/A."
    )
    source = recordings.sources("motor", *DATASHEET)
    named = {"a": (a, "N·m/A³"), "b": (b, "N·m/A²"), "c": (c, "N·m/A")}
    axes = panel(
        "current Iq / A",
        "torque constant kT / (N·m/A)",
        curve(current, fitted, "a·Iq² + b·Iq + c"),
        curve(points, given, "datasheet: stall and peak", "large dots"),
    )
    numbers = tuple(Number(name, value, unit, source=source) for name, (value, unit) in named.items())
    return TaskResult((findings,), numbers, (chart("Task 4: kT(Iq)", axes),))
