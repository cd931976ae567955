"""Task 3: the torque constant kT = M/I from stall and from peak."""

from __future__ import annotations

from bench.course.axis import Sources, joined
from bench.course.recordings import LabRecordings
from bench.course.result import DoneTask, Number
from bench.errors import InputError
from bench.rig.motor import DATASHEET
from bench.rig.rig import Rig

KEY, TITLE = "3", "Torque constant from the datasheet"


def torque_constants(rig: Rig) -> tuple[float, float]:
    """M0/I0 and Mmax/Imax - N*m/A.

    Raises:
        InputError: the motor lacks one of the four values.
    """
    values = [getattr(rig.motor, name) for name in DATASHEET]
    if None in values:
        raise InputError(f"{rig.source}: motor", "found no kT(Iq)", f"give {', '.join(DATASHEET)}")
    stall, stall_current, peak, peak_current = values
    return stall / stall_current, peak / peak_current


def datasheet(sources: Sources) -> str:
    """Source of the four values."""
    return joined(*(sources("motor", name) for name in DATASHEET))


def task(recordings: LabRecordings) -> DoneTask:
    """kT at both points."""
    stall, peak = torque_constants(recordings.rig)
    findings = (
        f"From stall to peak the torque per ampere falls from {stall:.4g} to {peak:.4g} N·m/A, by "
        f"{1 - peak / stall:.0%}. The stator's iron saturates: more current no longer raises the flux in "
        "proportion, so torque grows more slowly than current."
    )
    source = datasheet(recordings.sources)
    numbers = (
        Number("kT from stall", stall, "N·m/A", source=source),
        Number("kT from peak", peak, "N·m/A", source=source),
    )
    return DoneTask(KEY, TITLE, (findings,), numbers)
