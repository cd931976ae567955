"""Tracking experiment: the fast run with J_load = 0, theoretical and identified in the drive's feed-forward."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.arrays import Array, column_rms
from bench.course.result import SIMULATED, Chart, Curve, Number, Panel, Task
from bench.course.rig import rotor_inertia
from bench.course.sources import Sources, joined
from bench.course.t06_inertia import KG_CM2
from bench.errors import InputError
from bench.plant.drive import Cascade
from bench.plant.model import AxisParameters
from bench.plant.plant import Plant
from bench.plant.profiles import MotionLimits, plan
from bench.plant.run import run
from bench.rig.rig import Rig

KEY, TITLE = "tracking", "Tracking with three load inertias in the feed-forward"


def task(rig: Rig, sources: Sources, axis: AxisParameters, identified: float, known: bool) -> Task:
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
    rms = column_rms(deviation)
    numbers = []
    source = joined(SIMULATED, sources("drive", "position_gain"), sources("load", "outer_diameter"))
    for k, name in enumerate(loads):
        numbers.append(Number(f"largest deviation, {name}", float(np.abs(deviation[:, k]).max()), "deg", source=source))
        numbers.append(Number(f"RMS deviation, {name}", float(rms[k]), "deg", source=source))
    findings = (
        f"The simulated axis is that of the recording: J = {axis.inertia * KG_CM2:.4g} kg·cm², "
        + ("as it truly is." if known else "as task 9 found it, so that the identified J_load fits it by construction.")
        + f" The disk's geometry is {theory / (axis.inertia - rotor) - 1.0:+.1%} off its J_load, as hub, coupling and "
        "bolts turn, too.",
        f"Of the deviation without J_load the theoretical one leaves {rms[1] / rms[0]:.1%}, the identified one "
        f"{rms[2] / rms[0]:.1%}. What is left with that is friction, which the feed-forward does not know, at each "
        "reversal.",
    )
    labels = [f"{name}: {load * KG_CM2:.4g} kg·cm²" for name, load in loads.items()]
    return Task(KEY, TITLE, findings, tuple(numbers), (_chart(states.time, deviation, labels),))


def _chart(time: Array, deviation: Array, labels: list[str]) -> Chart:
    """Deviations over time - s, deg - (ticks, 3); again without the first, which hides the others."""
    every = slice(None, None, 4)
    curves = tuple(Curve(time[every], deviation[every, k], label) for k, label in enumerate(labels))
    panels = (
        Panel("time / s", "tracking deviation / deg", curves),
        Panel("time / s", "the same, without J_load = 0 / deg", curves[1:]),
    )
    return Chart("Tracking deviation of the fast run", panels)
