"""Task 9: J, viscous and Coulomb friction from A*theta = b with A = [alpha_filt, omega, sgn(omega)], b = M."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB
from bench.course.result import Chart, Curve, Number, Panel, Task
from bench.course.run import Run
from bench.course.sources import Sources
from bench.course.t06_inertia import KG_CM2, load_inertia, require_positive
from bench.course.t08_fast_samples import FastSamples, acceleration_of_all, fast_samples
from bench.errors import UndeterminedError
from bench.fit.determined import RECORD
from bench.fit.lab import least_squares
from bench.fit.rows import ONE_WAY
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
        UndeterminedError: they do not tell inertia and friction apart, or torque and acceleration oppose each other.
    """
    samples = fast_samples(run)
    weaker = 0.5 * (1.0 - abs(float(np.mean(np.sign(samples.velocity)))))
    if weaker < ONE_WAY:
        reason = "the axis moves one way only, so a constant torque and Coulomb friction are one number"
        raise UndeterminedError("Coulomb friction", reason, RECORD[COULOMB])
    theta, _, error = least_squares(samples.acceleration, samples.velocity, samples.torque)
    require_positive(float(theta[0]))
    return Friction(*theta.tolist(), error=error)


def task(run: Run, rig: Rig, sources: Sources, load_inertia_before: Number | None) -> Task:
    """Identify, and draw the reconstructed torque of every sample over the measured one.

    Args:
        run: with friction.
        rig: for the rotor's inertia.
        sources: of the rig's values.
        load_inertia_before: J_load of task 6, if that could be done.
    """
    found, fitted = identify_friction(run), fast_samples(run)
    every = FastSamples(run.time, run.velocity, acceleration_of_all(run), run.torque)
    residual = run.torque - found.torque(every)
    left = rms(residual)
    true = run.true("moment_of_inertia", KG_CM2)
    loads, _ = load_inertia(found.inertia, rig, sources, true)
    findings = [
        f"A = [α_filt, ω, sgn(ω)], b = M over the {fitted.time.size} samples of task 8; the theta with the least "
        "E = |A·theta - b|² is (J, K_fric_w, K_fric_0).",
        f"M_est is drawn for all {run.time.size} samples. It leaves {left:.3g} N·m RMS, "
        f"{left / rms(run.torque):.2%} of "
        f"the torque; over the fitted samples {np.sqrt(found.error / fitted.time.size):.3g} N·m.",
    ]
    if load_inertia_before is not None and loads:
        off = loads[0].value / load_inertia_before.value - 1.0
        findings.append(f"J_load is {off:+.2%} off the one of task 6.")
    curves = (
        Curve(run.time, run.torque, "measured torque M", "wide"),
        Curve(run.time, found.torque(every), "M_est, all samples"),
    )
    panels = (
        Panel("time / s", "torque / (N·m)", curves),
        Panel("time / s", "M - M_est / (N·m)", (Curve(run.time, residual),)),
    )
    numbers = (
        Number("J", found.inertia * KG_CM2, "kg·cm²", true),
        Number("K_fric_w", found.viscous, "N·m·s/rad", run.true("viscous_friction_coefficient")),
        Number("K_fric_0", found.coulomb, "N·m", run.true("coulomb_friction_torque")),
        Number("E", found.error, "(N·m)²"),
        *loads[:1],
        Number("samples of M_est", float(every.time.size), "1"),
        Number("RMS of M - M_est, all samples", left, "N·m"),
    )
    return Task(
        KEY, TITLE, tuple(findings), numbers, (Chart("Task 9: reconstructed torque over the measured one", panels),)
    )
