"""Task 9: J, viscous and Coulomb friction from A*theta = b with A = [alpha_filt, omega, sgn(omega)], b = M."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB
from bench.course import t06_inertia
from bench.course.axis import KG_CM2
from bench.course.recordings import LabRecordings, LabRun
from bench.course.result import DoneTask, Number, chart, curve, panel
from bench.course.t08_fast_samples import fast_samples, in_step
from bench.errors import BenchError, UndeterminedError
from bench.fit.determined import RECORD
from bench.fit.lab import least_squares
from bench.fit.rows import ONE_WAY

KEY, TITLE = "9", "Moment of inertia and friction by least squares"


@dataclass(frozen=True)
class EquationOfMotion:
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

    def torque(self, run: LabRun) -> Array:
        """J*alpha + K_fric_w*omega + K_fric_0*sgn(omega) - N*m."""
        friction = self.viscous * run.velocity + self.coulomb * np.sign(run.velocity)
        return self.inertia * run.acceleration + friction


def identify_friction(run: LabRun) -> EquationOfMotion:
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
    t06_inertia.require_positive(float(theta[0]))
    return EquationOfMotion(*theta.tolist(), error=error)


def task(recordings: LabRecordings) -> DoneTask:
    """Identify, and draw the reconstructed torque of every sample over the measured one."""
    run = recordings.with_friction
    found, fitted, every = identify_friction(run), fast_samples(run), in_step(run)
    residual = run.torque - found.torque(every)
    left, left_of_fitted = rms(residual), np.sqrt(found.error / fitted.time.size)
    true = run.true("moment_of_inertia", KG_CM2)
    loads, _ = t06_inertia.load_inertia(found.inertia, recordings, true)
    findings = (
        f"A = [α_filt, ω, sgn(ω)], b = M over the {fitted.time.size} samples of task 8; the theta with the least "
        "E = |A·theta - b|² is (J, K_fric_w, K_fric_0).",
        f"M_est is drawn for all {run.time.size} samples. It leaves {left:.3g} N·m RMS, "
        f"{left / rms(run.torque):.2%} of the torque; over the fitted samples {left_of_fitted:.3g} N·m.",
        *_beside_task_6(loads, recordings),
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
    measured = curve(run.time, run.torque, "measured torque M", "wide")
    drawn = chart(
        "Task 9: reconstructed torque over the measured one",
        panel("time / s", "torque / (N·m)", measured, curve(run.time, found.torque(every), "M_est, all samples")),
        panel("time / s", "M - M_est / (N·m)", curve(run.time, residual)),
    )
    return DoneTask(KEY, TITLE, findings, numbers, (drawn,))


def _beside_task_6(loads: list[Number], recordings: LabRecordings) -> tuple[str, ...]:
    """How far J_load is off that of task 6; nothing where that could not be done, which its own place says."""
    try:
        before = t06_inertia.task(recordings)
    except BenchError:
        return ()
    if not loads:
        return ()
    return (f"J_load is {loads[0].value / before['J_load'].value - 1.0:+.2%} off the one of task 6.",)
