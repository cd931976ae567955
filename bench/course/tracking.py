"""Tracking experiment: the fast run with J_load = 0, theoretical and identified in the drive's feed-forward."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.arrays import column_rms
from bench.course.axis import joined, motor_value
from bench.course.friction import identify_friction
from bench.course.methods import KG_CM2
from bench.course.recordings import LabRecordings
from bench.course.result import SIMULATED, Number, TaskResult, chart, curve, panel
from bench.course.winding import identified_axis
from bench.errors import InputError
from bench.names import percent
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.drive import Cascade
from bench.plant.plant import Plant
from bench.plant.profiles import MotionLimits, plan
from bench.plant.run import run


def tracking(recordings: LabRecordings) -> TaskResult:
    """The recording's axis with each feed-forward.

    Raises InputError as `track`, and UndeterminedError where task 9 cannot be done.
    """
    identified = identify_friction(recordings.with_friction).inertia - motor_value(recordings.rig, "rotor_inertia")
    known = bool(recordings.with_friction.truth)
    axis = AxisParameters.from_rig(recordings.example) if known else identified_axis(recordings)
    return track(recordings, axis, identified, known)


def track(recordings: LabRecordings, axis: AxisParameters, identified: float, known: bool) -> TaskResult:
    """Simulate the fast run with each feed-forward, and compare the deviations from the reference.

    Args:
        recordings: whose rig has a drive, the rotor's inertia and the disk's geometry; InputError where it lacks one.
        axis: of the recording; what moves in the simulation.
        identified: J_load - kg*m**2.
        known: whether `axis` is the recording's truth, or itself what was identified from it.
    """
    rig, sources = recordings.rig, recordings.sources
    theory = rig.load.disk_inertia if rig.load else None
    if theory is None:
        raise InputError(f"{rig.source}: load", "found no geometry of a disk", "the theoretical J_load comes from it")
    loads = {"J_load = 0": 0.0, "J_load theoretical": theory, "J_load identified": identified}
    rotor, cascade = motor_value(rig, "rotor_inertia"), Cascade.from_rig(rig)
    plant = Plant(AxisModel(axis), cascade, cascade.control_period, emulated=True)
    references = plan("fast_reversals", MotionLimits.from_rig(rig, axis, cascade.control_period))
    plants = [replace(plant, cascade=replace(cascade, inertia_feedforward=rotor + load)) for load in loads.values()]
    motions = [references.position - run(one, references).position for one in plants]
    deviation = np.degrees(np.stack(motions, axis=1))
    largest, rms = np.abs(deviation).max(axis=0).tolist(), column_rms(deviation).tolist()
    source = joined(SIMULATED, sources("drive", "position_gain"), sources("load", "outer_diameter"))
    numbers = tuple(
        Number(f"{what} deviation, {name}", value, "deg", source=source)
        for name, *both in zip(loads, largest, rms, strict=True)
        for what, value in zip(("largest", "RMS"), both, strict=True)
    )
    truly = "as it truly is." if known else "as task 9 found it, so that the identified J_load fits it by construction."
    findings = (
        f"The simulated axis is that of the recording: J = {axis.inertia * KG_CM2:.4g} kg·cm², {truly}"
        f" The disk's geometry is {theory / (axis.inertia - rotor) - 1.0:+.1%} off its J_load, as hub, coupling and "
        "bolts turn, too.",
        f"The theoretical J_load reduces the RMS deviation to {percent(rms[1] / rms[0])} of that without J_load, the "
        f"identified one to {percent(rms[2] / rms[0])}. The rest is friction at each reversal, not fed forward.",
    )
    drawn = [
        curve(references.time[::4], deviation[::4, k], f"{name}: {load * KG_CM2:.4g} kg·cm²")
        for k, (name, load) in enumerate(loads.items())
    ]
    both = (
        panel("time / s", "tracking deviation / deg", *drawn),
        panel("time / s", "with J_load / deg", *drawn[1:], first=1),  # which hides the others
    )
    return TaskResult(findings, numbers, (chart("Tracking deviation of the fast run", *both),))
