"""Tracking experiment: the fast run with J_load = 0, theoretical and identified in the drive's feed-forward."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.arrays import Array, column_rms
from bench.course.axis import KG_CM2, Sources, joined, rotor_inertia
from bench.course.recordings import LabRecordings
from bench.course.result import SIMULATED, DoneTask, Number, chart, curve, panel
from bench.course.t09_least_squares import identify_friction
from bench.course.t11_corner import identified_axis
from bench.errors import InputError
from bench.plant.axis_model import AxisParameters
from bench.plant.drive import Cascade
from bench.plant.plant import Plant
from bench.plant.profiles import MotionLimits, plan
from bench.plant.run import run
from bench.report.document import Chart
from bench.rig.rig import Rig

KEY, TITLE = "tracking", "Tracking with three load inertias in the feed-forward"


def task(recordings: LabRecordings) -> DoneTask:
    """The recording's axis with each feed-forward.

    Raises:
        InputError: the rig lacks a drive, the rotor's inertia or the disk's geometry.
        UndeterminedError: task 9 cannot be done.
    """
    identified = identify_friction(recordings.with_friction).inertia - rotor_inertia(recordings.rig)
    known = bool(recordings.with_friction.truth)
    axis = AxisParameters.from_rig(recordings.example) if known else identified_axis(recordings)
    return track(recordings.rig, recordings.sources, axis, identified, known)


def track(rig: Rig, sources: Sources, axis: AxisParameters, identified: float, known: bool) -> DoneTask:
    """Simulate the fast run with each feed-forward side by side, and compare the deviations from the reference.

    Args:
        rig: with a drive, the rotor's inertia and the disk's geometry.
        sources: of these.
        axis: of the recording; what moves in the simulation.
        identified: J_load - kg*m**2.
        known: whether `axis` is the recording's truth, or itself what was identified from it.

    Raises:
        InputError: the rig lacks one of them.
    """
    theory = rig.load.disk_inertia if rig.load else None
    if theory is None:
        raise InputError(f"{rig.source}: load", "found no geometry of a disk", "the theoretical J_load comes from it")
    rotor = rotor_inertia(rig)
    loads = {"J_load = 0": 0.0, "J_load theoretical": theory, "J_load identified": identified}
    cascade = Cascade.from_rig(rig)
    plant = Plant(axis, cascade, cascade.control_period, emulated=True)
    references = plan("fast_reversals", MotionLimits.from_rig(rig, axis, cascade.control_period))
    plants = [replace(plant, cascade=replace(cascade, inertia_feedforward=rotor + load)) for load in loads.values()]
    states = run(plants, [references] * len(plants))
    deviation = np.degrees(references.position[:, None] - states.position)
    largest, rms = np.abs(deviation).max(axis=0).tolist(), column_rms(deviation).tolist()
    source = joined(SIMULATED, sources("drive", "position_gain"), sources("load", "outer_diameter"))
    numbers = [
        Number(f"{what} deviation, {name}", values[k], "deg", source=source)
        for k, name in enumerate(loads)
        for what, values in (("largest", largest), ("RMS", rms))
    ]
    truly = "as it truly is." if known else "as task 9 found it, so that the identified J_load fits it by construction."
    findings = (
        f"The simulated axis is that of the recording: J = {axis.inertia * KG_CM2:.4g} kg·cm², {truly}"
        f" The disk's geometry is {theory / (axis.inertia - rotor) - 1.0:+.1%} off its J_load, as hub, coupling and "
        "bolts turn, too.",
        f"Of the deviation without J_load the theoretical one leaves {rms[1] / rms[0]:.1%}, the identified one "
        f"{rms[2] / rms[0]:.1%}. What is left with that is friction, which the feed-forward does not know, at each "
        "reversal.",
    )
    labels = [f"{name}: {load * KG_CM2:.4g} kg·cm²" for name, load in loads.items()]
    return DoneTask(KEY, TITLE, findings, tuple(numbers), (_chart(states.time, deviation, labels),))


def _chart(time: Array, deviation: Array, labels: list[str]) -> Chart:
    """Deviations over time - s, deg - (ticks, 3); again without the first, which hides the others."""
    every = slice(None, None, 4)
    curves = [curve(time[every], deviation[every, k], label) for k, label in enumerate(labels)]
    return chart(
        "Tracking deviation of the fast run",
        panel("time / s", "tracking deviation / deg", *curves),
        panel("time / s", "the same, without J_load = 0 / deg", *curves[1:], first=1),
    )
