"""Torque constants: kT = M/I from stall and peak (task 3), and the parabola through both, flat at zero (task 4)."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.course.recordings import LabRecordings
from bench.course.result import Number, TaskResult, chart, curve, panel
from bench.errors import InputError
from bench.names import percent
from bench.rig.motor import DATASHEET, TorqueConstant
from bench.rig.rig import Rig


def datasheet_points(rig: Rig) -> tuple[Array, Array, TorqueConstant]:
    """I0 and Imax - A -, torque constants M0/I0 and Mmax/Imax - N*m/A -, and kT(Iq) = a*Iq**2 + c through both.

    The course's kT'(0) = 0 is b = 0. Raises InputError where one value is missing.
    """
    values = [getattr(rig.motor, name) for name in DATASHEET]
    if None in values:
        raise InputError(f"{rig.source}: motor", "found no kT(Iq)", f"give {', '.join(DATASHEET)}")
    stall, stall_current, peak, peak_current = values
    constants = np.array([stall / stall_current, peak / peak_current])
    return np.array([stall_current, peak_current]), constants, TorqueConstant.from_datasheet(*values)


def at_both_points(recordings: LabRecordings) -> TaskResult:
    """kT at stall and at peak."""
    stall, peak = datasheet_points(recordings.rig)[1].tolist()
    findings = (
        f"kT is {stall:.4g} N·m/A at stall and {peak:.4g} N·m/A at peak. It falls by "
        f"{percent(1 - peak / stall)}, as the stator's iron saturates: more current no longer raises the flux in "
        "proportion, so torque grows more slowly than current."
    )
    constants = {"kT from stall": stall, "kT from peak": peak}
    source = recordings.sources("motor", *DATASHEET)
    return TaskResult((findings,), tuple(Number(name, kt, "N·m/A", source=source) for name, kt in constants.items()))


def over_current(recordings: LabRecordings) -> TaskResult:
    """Coefficients, check and curve of kT(Iq)."""
    points, given, constant = datasheet_points(recordings.rig)
    current = np.linspace(0.0, points[1], 400)
    fitted = constant(current)
    falls = "falls monotonically" if np.all(np.diff(fitted[1:]) < 0.0) else "does not fall everywhere"
    findings = (
        f"kT(Iq) = {constant.curvature:.4g}·Iq² + {constant.constant:.4g} N·m/A with Iq in A. It is flat at zero, "
        f"{falls} up to {points[1]:g} A, and passes through both points of the datasheet."
    )
    named = {"a": (constant.curvature, "N·m/A³"), "b": (0.0, "N·m/A²"), "c": (constant.constant, "N·m/A")}
    source = recordings.sources("motor", *DATASHEET)
    numbers = tuple(Number(name, value, unit, source=source) for name, (value, unit) in named.items())
    axes = panel(
        "current Iq / A",
        "torque constant kT / (N·m/A)",
        curve(current, fitted, "a·Iq² + b·Iq + c"),
        curve(points, given, "datasheet: stall and peak", "large dots"),
    )
    return TaskResult((findings,), numbers, (chart("Task 4: kT(Iq)", axes),))
