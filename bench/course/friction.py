"""Tasks 8 and 9: inertia and friction from the samples that are fast enough.

A*theta = b with A = [alpha_filt, omega, sgn(omega)], b = M, theta = (J, K_fric_w, K_fric_0), over |omega| >= 20 rad/s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB
from bench.course.inertia import (
    four_signals,
    half_width,
    inertia_without_friction,
    load_inertia,
    require_positive,
    torque_chart,
)
from bench.course.methods import DELAY, KG_CM2, LEAST_SPEED, WIDTH, fast_samples, filtered_acceleration
from bench.course.recordings import LabRecordings
from bench.course.result import Number, TaskResult, chart, curve, panel
from bench.course.run import LabRun
from bench.errors import BenchError, UndeterminedError
from bench.fit.determined import RECORD
from bench.fit.lab import least_squares
from bench.fit.rows import ONE_WAY
from bench.names import percent
from bench.trace.filter import GaussianFilter

#: Name of the torque that inertia and friction do not explain.
REMAINING = "RMS of M - M_est, all samples"
#: Width of the filter by which lateness is measured - samples.
SMOOTHING = 5.0


def in_step(run: LabRun) -> LabRun:
    """The run with alpha_filt on t_sync for its acceleration, and the gradient at the ends, which the filter loses."""
    mean, synchronous = filtered_acceleration(run.acceleration)
    alpha = np.gradient(run.velocity, run.sample_period)
    alpha[synchronous] = mean
    return replace(run, acceleration=alpha)


def remaining(run: LabRun) -> NDArray[np.bool_]:
    """Samples with |omega| >= 20 rad/s on t_sync; UndeterminedError where the recording is too slow."""
    fast = fast_samples(run.velocity)
    if not fast.any():
        least = f"a run that passes {LEAST_SPEED:g} rad/s in both directions"
        raise UndeterminedError("inertia and friction", f"no sample is faster than {LEAST_SPEED:g} rad/s", least)
    return fast


def lateness(run: LabRun, late: int = 0) -> float:
    """By how much alpha_filt, `late` samples later than on t_sync, comes after the speed's own derivative - samples.

    Both are smoothed by one filter that is even in time, so noise and smoothing are alike in them. What is late by tau
    is alpha - tau*alpha', and tau its least-squares estimate.
    """
    mean, synchronous = filtered_acceleration(run.acceleration)
    speed = run.velocity[synchronous.start + late : synchronous.stop + late]
    smooth = GaussianFilter(SMOOTHING * run.sample_period, run.sample_period)
    slope, bend = smooth(speed, 1, 2)
    behind = slope - smooth(mean[: speed.size], 0)[0]
    return float(behind @ bend / (bend @ bend) / run.sample_period)


def samples_that_remain(recordings: LabRecordings) -> TaskResult:
    """Task 8: alpha_filt in step with the speed, and the remaining samples over those of task 7."""
    run = recordings.with_friction
    fast = remaining(run)
    # thousandths of a sample are rounding
    on_t_sync, as_it_comes = (round(lateness(run, late), 3) + 0.0 for late in (0, DELAY))
    kept, removed = np.count_nonzero(fast), np.count_nonzero(~fast)
    findings = (
        f"{kept} of {run.time.size} samples remain; {removed} are slower than {LEAST_SPEED:g} rad/s, where friction is "
        "no constant, or at the ends of the filter.",
        f"alpha_filt is the mean of {WIDTH} backward differences. It is {DELAY} samples late, half a sample of "
        "that from the difference itself; t_sync corrects this.",
        f"Against the speed's own derivative, both smoothed alike, alpha_filt on t_sync is {on_t_sync:+.2f} samples "
        f"late, and {as_it_comes:+.2f} as the filter delivers it.",
    )
    numbers = (
        Number("samples remaining", float(kept), "1"),
        Number("samples removed", float(removed), "1"),
        Number("alpha_filt late, on t_sync", on_t_sync, "samples"),
        Number("alpha_filt late, as it comes", as_it_comes, "samples"),
    )
    panels = []
    for label, (at, values) in four_signals(run).items():
        time, left = run.time[at], fast[at]
        both = curve(time, values, "original", "wide"), curve(time[left], values[left], "remaining", "dots")
        panels.append(panel("t_sync / s", label, *both))
    return TaskResult(findings, numbers, (chart("Task 8: remaining samples over those of task 7", *panels),))


@dataclass(frozen=True)
class EquationOfMotion:
    """What the course finds.

    Attributes:
        inertia: J - kg*m**2.
        viscous: K_fric_w - N*m*s/rad.
        coulomb: K_fric_0 - N*m.
        error: E, remaining quadratic error - (N*m)**2.
        halves: within how much J, K_fric_w and K_fric_0 are known, in their units.
    """

    inertia: float
    viscous: float
    coulomb: float
    error: float
    halves: tuple[float, ...]

    def torque(self, run: LabRun) -> Array:
        """J*alpha + K_fric_w*omega + K_fric_0*sgn(omega) - N*m."""
        friction = self.viscous * run.velocity + self.coulomb * np.sign(run.velocity)
        return self.inertia * run.acceleration + friction


def identify_friction(run: LabRun) -> EquationOfMotion:
    """The course's least squares on the fast samples of a recording.

    Raises UndeterminedError where they do not separate inertia and friction, or torque and acceleration are opposed.
    """
    samples = in_step(run).at(remaining(run))
    weaker = 0.5 * (1.0 - abs(float(np.mean(np.sign(samples.velocity)))))
    if weaker < ONE_WAY:
        reason = "the axis moves one way only, so a constant torque and Coulomb friction are one number"
        raise UndeterminedError("Coulomb friction", reason, RECORD[COULOMB])
    theta, std_error, error = least_squares(samples.acceleration, samples.velocity, samples.torque)
    require_positive(float(theta[0]))
    estimates = zip(theta.tolist(), std_error.tolist(), ("inertia", "viscous", "coulomb"), strict=True)
    halves = tuple(half_width(value, deviation, name, run) for value, deviation, name in estimates)
    return EquationOfMotion(*theta.tolist(), error=error, halves=halves)


def inertia_and_friction(recordings: LabRecordings) -> TaskResult:
    """Task 9: identify, and draw the reconstructed torque of every sample over the measured one."""
    run = recordings.with_friction
    found, fitted = identify_friction(run), np.count_nonzero(remaining(run))
    estimated = found.torque(in_step(run))
    left, left_of_fitted = rms(run.torque - estimated), math.sqrt(found.error / fitted)
    true = run.true("moment_of_inertia", KG_CM2)
    half = found.halves
    loads, _ = load_inertia(found.inertia, half[0], recordings, true)
    findings = (
        f"J is {found.inertia * KG_CM2:.4g} ± {half[0] * KG_CM2:.1g} kg·cm², K_fric_w {found.viscous:.3g} N·m·s/rad "
        f"and K_fric_0 {found.coulomb:.3g} N·m.",
        f"A = [α_filt, ω, sgn(ω)], b = M over the {fitted} samples of task 8; the theta with the least "
        "E = |A·theta - b|² is (J, K_fric_w, K_fric_0).",
        f"M_est is drawn for all {run.time.size} samples. M - M_est is {left:.3g} N·m RMS, "
        f"{percent(left / rms(run.torque))} of the torque; over the fitted samples {left_of_fitted:.3g} N·m.",
        *_difference_from_task_6(loads, recordings),
    )
    numbers = (
        Number("J", found.inertia * KG_CM2, "kg·cm²", true, half=half[0] * KG_CM2),
        Number("K_fric_w", found.viscous, "N·m·s/rad", run.true("viscous_friction_coefficient"), half=half[1]),
        Number("K_fric_0", found.coulomb, "N·m", run.true("coulomb_friction_torque"), half=half[2]),
        Number("E", found.error, "(N·m)²"),
        *loads[:1],
        Number("samples of M_est", float(estimated.size), "1"),
        Number(REMAINING, left, "N·m"),
    )
    title, name = "Task 9: reconstructed torque over the measured one", "M_est, all samples"
    return TaskResult(findings, numbers, (torque_chart(title, run, estimated, name, "M_est"),))


def _difference_from_task_6(loads: list[Number], recordings: LabRecordings) -> tuple[str, ...]:
    """How far J_load is off that of task 6; nothing where that could not be done, which is reported there."""
    try:
        before = inertia_without_friction(recordings)
    except BenchError:
        return ()
    if not loads:
        return ()
    load, other = loads[0], before["J_load"]
    apart, half = load.value - other.value, math.hypot(load.half or 0.0, other.half or 0.0)
    agree = "the two agree" if abs(apart) <= half else "the two contradict each other"
    share = apart / other.value
    return (f"J_load is {share:+.2%} off the one of task 6, {apart:+.2g} ± {half:.2g} kg·cm²: {agree}.",)
