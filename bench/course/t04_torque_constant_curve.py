"""Task 4: kT(Iq) = a*Iq**2 + b*Iq + c from three conditions: flat at zero, and both points of the datasheet."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.course.result import Chart, Curve, Number, Panel, Task
from bench.course.sources import Sources
from bench.course.t03_torque_constants import datasheet, torque_constants
from bench.rig.motor import Motor
from bench.rig.rig import Rig

KEY, TITLE = "4", "Torque constant over current"


def coefficients(motor: Motor, where: str) -> Array:
    """a - N*m/A**3, b - N*m/A**2, c - N*m/A of three linear equations.

    kT'(0) = 0, which is b = 0 and leaves two: kT(I0) = M0/I0, kT(Imax) = Mmax/Imax.

    Raises:
        InputError: the motor lacks one of the four values.
    """
    stall, peak = torque_constants(motor, where)
    low, high = motor.continuous_stall_current or 0.0, motor.peak_current or 0.0
    a, c = np.linalg.solve(np.array([[low**2, 1.0], [high**2, 1.0]]), np.array([stall, peak]))
    return np.array([a, 0.0, c])


def task(rig: Rig, sources: Sources) -> Task:
    """Solve for the coefficients, check and draw the curve."""
    motor = rig.motor
    a, b, c = coefficients(motor, rig.source)
    stall, peak = torque_constants(motor, rig.source)
    currents = np.array([motor.continuous_stall_current or 0.0, motor.peak_current or 0.0])
    current = np.linspace(0.0, currents[1], 400)
    curve = a * current**2 + b * current + c
    met = np.abs(a * currents**2 + b * currents + c - [stall, peak])
    falls = bool(np.all(np.diff(curve[1:]) < 0.0))
    return Task(
        KEY,
        TITLE,
        (
            f"Checked: slope at zero {b:g} N·m/A²; "
            f"{'falls monotonically' if falls else 'does not fall everywhere'} "
            f"up to {currents[1]:g} A; both points of the datasheet met within {met.max():.1g} N·m/A.",
        ),
        tuple(
            Number(name, float(value), unit, source=datasheet(sources))
            for name, value, unit in zip("abc", (a, b, c), ("N·m/A³", "N·m/A²", "N·m/A"), strict=True)
        ),
        (
            Chart(
                "kT(Iq)",
                (
                    Panel(
                        "current Iq / A",
                        "torque constant kT / (N·m/A)",
                        (
                            Curve(current, curve, "a·Iq² + b·Iq + c"),
                            Curve(currents, np.array([stall, peak]), "datasheet: stall and peak", "bold dots"),
                        ),
                    ),
                ),
            ),
        ),
    )
