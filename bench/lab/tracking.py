"""Tracking experiment: the fast run with J_load = 0, theoretical and identified in the drive's feed-forward."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.arrays import Array, column_rms
from bench.errors import InputError
from bench.lab.result import Chart, Curve, Number, Panel, Task
from bench.lab.rig import rotor_inertia
from bench.lab.t06_inertia import KG_CM2
from bench.plant.limits import MotionLimits
from bench.plant.plant import Plant
from bench.plant.profiles import plan
from bench.plant.run import run
from bench.rig.rig import Rig

KEY, TITLE = "tracking", "Tracking with three load inertias in the feed-forward"


def task(rig: Rig, identified: float) -> Task:
    """Simulate the fast run with each feed-forward side by side, and compare the deviations from the reference.

    Args:
        rig: with drive and simulation.
        identified: J_load - kg*m**2.

    Raises:
        InputError: the rig lacks what the simulation needs, or the disk's geometry.
    """
    theory = rig.load.disk_inertia if rig.load else None
    if theory is None:
        raise InputError(f"{rig.source}: load", "found no geometry of a disk", "the theoretical J_load comes from it")
    rotor = rotor_inertia(rig)
    loads = {"J_load = 0": 0.0, "J_load theoretical": theory, "J_load identified": identified}
    plant = Plant.from_rig(rig)
    period = plant.cascade.control_period
    references = plan("fast_reversals", MotionLimits.from_rig(rig, plant.parameters, period))
    plants = [
        replace(plant, cascade=replace(plant.cascade, inertia_feedforward=rotor + load)) for load in loads.values()
    ]
    states = run(plants, [references] * len(plants))
    deviation = np.degrees(references.position[:, None] - states.position)
    rms = column_rms(deviation)
    numbers = []
    for k, name in enumerate(loads):
        numbers.append(Number(f"largest deviation, {name}", float(np.abs(deviation[:, k]).max()), "deg"))
        numbers.append(Number(f"RMS deviation, {name}", float(rms[k]), "deg"))
    return Task(
        KEY,
        TITLE,
        (
            f"The simulated axis has J = {plant.parameters.inertia * KG_CM2:.4g} kg·cm².",
            f"The identified inertia leaves {rms[2] / rms[0]:.1%} of the deviation without J_load, the theoretical one "
            f"{rms[1] / rms[0]:.1%}. What is left is friction, which the feed-forward does not know, at each reversal.",
        ),
        tuple(numbers),
        (_chart(states.time, deviation, [f"{name}: {load * KG_CM2:.4g} kg·cm²" for name, load in loads.items()]),),
    )


def _chart(time: Array, deviation: Array, labels: list[str]) -> Chart:
    """Deviations over time - s, deg - (ticks, 3); again without the first, which hides the others."""
    every = slice(None, None, 4)
    curves = tuple(Curve(time[every], deviation[every, k], label) for k, label in enumerate(labels))
    panels = (
        Panel("time / s", "tracking deviation / deg", curves),
        Panel("time / s", "the same, without J_load = 0 / deg", curves[1:]),
    )
    return Chart("Tracking deviation of the fast run", panels)
