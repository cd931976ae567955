"""Task 3: the torque constant kT = M/I from stall and from peak."""

from __future__ import annotations

from bench.course.result import Number, Task
from bench.course.sources import Sources, joined
from bench.errors import InputError
from bench.rig.motor import DATASHEET, Motor
from bench.rig.rig import Rig

KEY, TITLE = "3", "Torque constant from the datasheet"


def task(rig: Rig, sources: Sources) -> Task:
    """kT at both points.

    Raises:
        InputError: the motor lacks one of the four values.
    """
    stall, peak = torque_constants(rig.motor, rig.source)
    return Task(
        KEY,
        TITLE,
        (
            f"From stall to peak the torque per ampere falls from {stall:.4g} to {peak:.4g} N·m/A, by "
            f"{1 - peak / stall:.0%}. The stator's iron saturates: more current no longer raises the flux in "
            "proportion, so torque grows more slowly than current.",
        ),
        (
            Number("kT from stall", stall, "N·m/A", source=datasheet(sources)),
            Number("kT from peak", peak, "N·m/A", source=datasheet(sources)),
        ),
    )


def datasheet(sources: Sources) -> str:
    """Source of the four values."""
    return joined(*(sources("motor", name) for name in DATASHEET))


def torque_constants(motor: Motor, where: str) -> tuple[float, float]:
    """M0/I0 and Mmax/Imax - N*m/A."""
    stall, stall_current = motor.continuous_stall_torque, motor.continuous_stall_current
    peak, peak_current = motor.peak_torque, motor.peak_current
    if stall is None or stall_current is None or peak is None or peak_current is None:
        raise InputError(f"{where}: motor", "found no kT(Iq)", f"give {', '.join(DATASHEET)}")
    return stall / stall_current, peak / peak_current
