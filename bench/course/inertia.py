"""Tasks 2 and 5 to 7: the backward difference, both recordings in SI, and inertia where nothing but inertia resists."""

from __future__ import annotations

import math

import numpy as np

from bench.arrays import NORMAL95, Array, rms
from bench.axis_kind import INERTIA
from bench.course.axis import TURN, joined
from bench.course.methods import KG_CM2, filtered_acceleration, mean_inertia, num_derivative
from bench.course.plausible import balance
from bench.course.recordings import LabRecordings
from bench.course.result import COMPUTED, RECORDING, Number, TaskResult, chart, curve, panel
from bench.course.run import LabRun
from bench.errors import InputError, UndeterminedError
from bench.fit.determined import RECORD
from bench.names import percent
from bench.report.document import Chart

#: Of the sine - s.
SAMPLE_PERIOD = 1e-3
#: One period, as the course has it, t = 0 : 0.001 : 2*pi - s.
DURATION = 2.0 * np.pi


def backward_difference_of_a_sine(recordings: LabRecordings) -> TaskResult:
    """Differentiate sin(t) and compare with cos(t): half a sample late, the difference errs by T/2*|u''|."""
    time = np.arange(0.0, DURATION, SAMPLE_PERIOD)
    backward = num_derivative(np.sin(time), SAMPLE_PERIOD)
    error = (backward - np.cos(time))[1:]
    worst = float(np.max(np.abs(error)))
    findings = (
        f"The backward difference of sin(t), t = 0 : {SAMPLE_PERIOD:g} : 2π ({time.size} samples), is at most "
        f"{worst:.2g} 1/s away from cos(t): it is half a sample late. Its first value is 0 by definition."
    )
    numbers = (Number("largest error of the backward difference", worst, "1/s", SAMPLE_PERIOD / 2.0, COMPUTED),)
    both = curve(time, np.cos(time), "cos(t)", "wide"), curve(time, backward, "backward difference", "dashes")
    drawn = chart(
        "Task 2: derivative of sin(t) against cos(t)",
        panel("time / s", "derivative / (1/s)", *both),
        panel("time / s", "error / (1/s)", curve(time[1:], error)),
    )
    return TaskResult((findings,), numbers, (drawn,))


def signals(name: str, title: str, recordings: LabRecordings) -> TaskResult:
    """Tasks 5 and 7: speed, acceleration, filtered acceleration and torque one above the other, and how far they reach.

    They are drawn of a recording that cannot be of the axis, too, for what is wrong with it to be seen.
    """
    run = recordings.run(name)
    shown = (panel("time / s", label, curve(run.time[at], values)) for label, (at, values) in four_signals(run).items())
    drawn = chart(title, *shown)
    try:
        recordings.sound(name)
    except InputError as reason:
        return TaskResult(charts=(drawn,), reason=reason)
    speed, acceleration, torque = (float(np.abs(one).max()) for one in (run.velocity, run.acceleration, run.torque))
    findings = (
        f"The axis reaches {speed:.4g} rad/s, {acceleration:.4g} rad/s² and {torque:.3g} N·m in {run.time[-1]:.3g} s "
        f"({run.time.size} samples, one each {run.sample_period * 1e3:.4g} ms).",
        *run.notes,
    )
    numbers = (
        Number("largest speed", speed, "rad/s"),
        Number("largest acceleration", acceleration, "rad/s²"),
        Number("largest torque", torque, "N·m"),
    )
    return TaskResult(findings, numbers, (drawn,))


def four_signals(run: LabRun) -> dict[str, tuple[slice, Array]]:
    """Speed, acceleration, alpha_filt and torque, each with the samples at which it is known, by the graph's label."""
    mean, synchronous = filtered_acceleration(run.acceleration)
    return {
        "speed ω / (rad/s)": (slice(None), run.velocity),
        "acceleration α / (rad/s²)": (slice(None), run.acceleration),
        "filtered α_filt / (rad/s²)": (synchronous, mean),
        "torque M / (N·m)": (slice(None), run.torque),
    }


def half_width(value: float, std_error: float, name: str, run: LabRun) -> float:
    """Half width of 95 % of a quantity of a balance, in its unit: by noise, and by the change with another filter.

    On 40 recorded axes the truth lay within it each time; by the standard error of J in task 9 alone 13 times, as
    smoothing of alpha shifts it by more than noise does.
    """
    found = balance(run)
    return NORMAL95 * std_error + (abs(value - getattr(found, name)) if found is not None else 0.0)


def require_positive(inertia: float) -> None:
    """UndeterminedError where torque and acceleration oppose each other."""
    if not inertia > 0.0:
        raise UndeterminedError(
            "moment of inertia",
            f"it comes out as {inertia * KG_CM2:.3g} kg*cm**2, as torque and acceleration have opposite signs",
            f"or {TURN}",
        )


def load_inertia(
    inertia: float, half: float, recordings: LabRecordings, true: float | None
) -> tuple[list[Number], list[str]]:
    """J_load = J - J_motor and the theory of the disk, as far as the rig has them, with remarks.

    Args:
        inertia, half: J, and within how much it is known - kg*m**2.
        recordings: whose rig has the rotor's inertia and the disk's geometry.
        true: J of a simulated axis - kg*cm**2.
    """
    rig, sources = recordings.rig, recordings.sources
    rotor, theory = rig.motor.rotor_inertia, rig.load.disk_inertia if rig.load else None
    if rotor is None:
        return [], [f"J_load = J - J_motor is undetermined: {rig.source} gives no motor.rotor_inertia."]
    load, source = inertia - rotor, sources("motor", "rotor_inertia")
    true_load = None if true is None else true - rotor * KG_CM2
    numbers = [
        Number("J_load", load * KG_CM2, "kg·cm²", true_load, joined(RECORDING, f"J_motor: {source}"), half * KG_CM2)
    ]
    findings = [f"J_motor = {rotor * KG_CM2:.3g} kg·cm² ({source})."]
    if theory is not None:
        disk = sources("load", "outer_diameter")
        numbers.append(Number("J_load, theory", theory * KG_CM2, "kg·cm²", source=f"disk: {disk}"))
        findings.append(
            f"J_load is {load / theory - 1.0:+.2%} off what the disk's geometry gives ({disk}); hub, coupling and "
            "bolts are not part of it."
        )
    return numbers, findings


def inertia_without_friction(recordings: LabRecordings) -> TaskResult:
    """Task 6: alpha_max, J from samples with |alpha| >= alpha_max/4, J_load = J - J_motor and its theory.

    Raises UndeterminedError where the axis never accelerates, or torque and acceleration oppose each other.
    """
    run = recordings.without_friction
    if not run.acceleration.any():
        raise UndeterminedError("moment of inertia", "the speed never changes", RECORD[INERTIA])
    inertia, largest, taken = mean_inertia(run.acceleration, run.torque)
    require_positive(inertia)
    true = run.true("moment_of_inertia", KG_CM2)
    ratio = run.torque[taken] / run.acceleration[taken]
    half = half_width(inertia, float(np.std(ratio)) / math.sqrt(ratio.size), "inertia", run)
    loads, of_load = load_inertia(inertia, half, recordings, true)
    modelled = inertia * run.acceleration
    left = rms((run.torque - modelled)[taken])
    findings = (
        f"{taken.sum()} of {taken.size} samples accelerate at alpha_max/4 or more; J is the mean of M/α over them, "
        f"{inertia * KG_CM2:.4g} ± {half * KG_CM2:.1g} kg·cm².",
        "In which unit? N·m over rad/s² is N·m·s² = kg·m², as the radian counts as 1; 1 kg·m² = 10⁴ kg·cm².",
        f"M - J·α is {left:.3g} N·m RMS, {percent(left / rms(run.torque[taken]))} of the torque of "
        f"these samples. M/α itself scatters by {percent(float(np.std(ratio) / abs(np.mean(ratio))))} from sample to "
        "sample, most of it noise of the differentiated speed.",
        *of_load,
    )
    numbers = (
        Number("alpha_max", largest, "rad/s²"),
        Number("J", inertia * KG_CM2, "kg·cm²", true, half=half * KG_CM2),
        *loads,
        Number("RMS of M - J·α", left, "N·m"),
    )
    drawn = torque_chart("Task 6: J·α over the measured torque", run, modelled, "J·α", "J·α")
    return TaskResult(findings, numbers, (drawn,))


def torque_chart(title: str, run: LabRun, modelled: Array, name: str, symbol: str) -> Chart:
    """A modelled torque (n,) - N*m - over the measured one, and its residual, labelled `symbol`."""
    measured, over_it = curve(run.time, run.torque, "measured torque M", "wide"), curve(run.time, modelled, name)
    return chart(
        title,
        panel("time / s", "torque / (N·m)", measured, over_it),
        panel("time / s", f"M - {symbol} / (N·m)", curve(run.time, run.torque - modelled)),
    )
