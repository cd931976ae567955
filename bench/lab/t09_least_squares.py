"""Task 9: J, viscous and Coulomb friction from A*theta = b with A = [alpha_filt, omega, sgn(omega)], b = M."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.identify.lab import least_squares
from bench.lab.result import Chart, Curve, Number, Panel, Task
from bench.lab.rig import rotor_inertia
from bench.lab.run import Run
from bench.lab.t06_inertia import KG_CM2
from bench.lab.t08_fast_samples import FastSamples, fast_samples
from bench.rig.rig import Rig

KEY, TITLE = "9", "Moment of inertia and friction by least squares"


@dataclass(frozen=True)
class Friction:
    """What the course finds.

    Attributes:
        inertia: J - kg*m**2.
        viscous: K_fric_w - N*m*s/rad.
        coulomb: K_fric_0 - N*m.
        error: E, remaining quadratic error - (N*m)**2.
    """

    inertia: float
    viscous: float
    coulomb: float
    error: float

    def torque(self, samples: FastSamples) -> Array:
        """J*alpha_filt + K_fric_w*omega + K_fric_0*sgn(omega) - N*m."""
        friction = self.viscous * samples.velocity + self.coulomb * np.sign(samples.velocity)
        return self.inertia * samples.acceleration + friction


def identify_friction(run: Run) -> Friction:
    """The course's least squares on the fast samples of a recording.

    Raises:
        UndeterminedError: they do not tell inertia and friction apart.
    """
    samples = fast_samples(run)
    theta, _, error = least_squares(samples.acceleration, samples.velocity, samples.torque)
    return Friction(*theta.tolist(), error=error)


def task(run: Run, rig: Rig, load_inertia: Number | None) -> Task:
    """Identify, and draw the reconstructed torque over the measured one.

    Args:
        run: with friction.
        rig: for the rotor's inertia.
        load_inertia: J_load of task 6, if that could be done.
    """
    found, samples = identify_friction(run), fast_samples(run)
    rotor = rotor_inertia(rig) * KG_CM2
    true = run.true("moment_of_inertia", KG_CM2)
    load = found.inertia * KG_CM2 - rotor
    says = ["A = [α_filt, ω, sgn(ω)], b = M; the theta with the least E = |A·theta - b|² is (J, K_fric_w, K_fric_0)."]
    if load_inertia is not None:
        says.append(f"J_load is {load / load_inertia.value - 1.0:+.2%} off the one of task 6.")
    curves = (
        Curve(run.time, run.torque, "measured torque", "wide"),
        Curve(samples.time, found.torque(samples), "reconstructed", "dots"),
    )
    return Task(
        KEY,
        TITLE,
        tuple(says),
        (
            Number("J", found.inertia * KG_CM2, "kg·cm²", true),
            Number("K_fric_w", found.viscous, "N·m·s/rad", run.true("viscous_friction_coefficient")),
            Number("K_fric_0", found.coulomb, "N·m", run.true("coulomb_friction_torque")),
            Number("E", found.error, "(N·m)²"),
            Number("J_load", load, "kg·cm²", None if true is None else true - rotor),
        ),
        (Chart("Task 9: reconstructed torque over the measured one", (Panel("time / s", "torque / (N·m)", curves),)),),
    )
