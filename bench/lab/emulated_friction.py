"""Friction emulated by the drive's software against friction in the mechanics: the same coefficients are identified."""

from __future__ import annotations

from bench.identify.regression import identify
from bench.lab.result import Number, Task
from bench.lab.rig import simulated_with, torque_constant
from bench.lab.run import run_of
from bench.lab.t06_inertia import KG_CM2
from bench.lab.t09_least_squares import identify_friction
from bench.plant.model import AxisParameters
from bench.plant.simulate import simulate
from bench.rig.rig import Rig

KEY, TITLE = "emulation", "Friction in the drive's software and in the mechanics"

PLACES = {"drive": "emulated", "mechanics": "in the mechanics"}


def task(rig: Rig) -> Task:
    """Simulate both, identify both as the course does and by the default estimator.

    Raises:
        InputError: the rig lacks what the simulation needs.
    """
    torque_constant(rig)
    truth = AxisParameters.from_rig(rig)
    numbers, by_place = [], []
    for place, words in PLACES.items():
        trace = simulate(simulated_with(rig, friction=place), "fast_reversals").trace
        found, default = identify_friction(run_of(trace, rig)), identify(trace, rig)
        viscous, coulomb = truth.viscous_friction_coefficient, truth.coulomb_friction
        numbers += [
            Number(f"J, {words}", found.inertia * KG_CM2, "kg·cm²", truth.inertia * KG_CM2),
            Number(f"K_fric_w, {words}", found.viscous, "N·m·s/rad", viscous),
            Number(f"K_fric_0, {words}", found.coulomb, "N·m", coulomb),
            Number(f"K_fric_w, {words}, bench", default["viscous_friction_coefficient"].value, "N·m·s/rad", viscous),
            Number(f"K_fric_0, {words}, bench", default["coulomb_friction_torque"].value, "N·m", coulomb),
        ]
        by_place.append((found.viscous, found.coulomb))
    (viscous, coulomb), (other_viscous, other_coulomb) = by_place
    says = (
        f"Emulated, K_fric_w is {abs(viscous / other_viscous - 1.0):.2%} and K_fric_0 "
        f"{abs(coulomb / other_coulomb - 1.0):.2%} off what the same friction in the mechanics gives: whoever reads "
        "current and speed cannot tell where friction sits.",
    )
    return Task(KEY, TITLE, says, tuple(numbers))
