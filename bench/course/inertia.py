"""Tasks 2 and 5 to 7: acceleration, both recordings in SI, and inertia where nothing but inertia resists.

Acceleration is the backward difference u'[k] = (u[k] - u[k-1])/T of the speed; task 2 has it of a sine, beside the
bench's own. Inertia is the mean of M/alpha.
"""

from __future__ import annotations

import math

import numpy as np

from bench.arrays import NORMAL95, Array, rms
from bench.course.axis import KG_CM2, joined
from bench.course.plausible import balance
from bench.course.recordings import LabRecordings, LabRun
from bench.course.result import COMPUTED, RECORDING, Number, TaskResult, chart, curve, panel
from bench.errors import InputError, UndeterminedError
from bench.fit.lab import backward_difference, mean_inertia
from bench.report.document import Chart
from bench.trace.filter import GaussianFilter

#: Of the sine - s.
SAMPLE_PERIOD = 1e-3
#: One period, as the course has it, t = 0 : 0.001 : 2*pi - s.
DURATION = 2.0 * np.pi
#: Width of the bench's filter, as it chooses it for the lab's recordings - s.
WIDTH = 2.0 * SAMPLE_PERIOD


def backward_difference_of_a_sine(recordings: LabRecordings) -> TaskResult:
    """Differentiate sin(t) both ways and compare with cos(t).

    The backward difference belongs half a sample earlier, so it errs by T/2*|u''|: 5e-4 here. The bench's filter is
    even in time and scales a sine by exp(-(omega*width)**2/2): 2e-6 here; it cannot serve the ends, six widths long.
    """
    time = np.arange(0.0, DURATION, SAMPLE_PERIOD)
    backward = backward_difference(np.sin(time), SAMPLE_PERIOD)
    smooth = GaussianFilter(WIDTH, SAMPLE_PERIOD)
    kept = slice(smooth.margin, time.size - smooth.margin)
    error = (backward - np.cos(time))[1:]
    error_of_bench = smooth(np.sin(time), 1)[0] - np.cos(time[kept])
    worst, worst_of_bench = float(np.max(np.abs(error))), float(np.max(np.abs(error_of_bench)))
    findings = (
        f"On sin(t), t = 0 : {SAMPLE_PERIOD:g} : 2π ({time.size} samples), the backward difference is at "
        f"most {worst:.2g} away from cos(t), half a sample of delay; the bench's own derivative "
        f"{worst_of_bench:.2g}. Its first value is 0 by definition."
    )
    numbers = (
        Number("largest error of the backward difference", worst, "1/s", SAMPLE_PERIOD / 2.0, COMPUTED),
        Number("largest error of the bench's derivative", worst_of_bench, "1/s", WIDTH**2 / 2.0, COMPUTED),
    )
    both = curve(time, np.cos(time), "cos(t)", "wide"), curve(time, backward, "backward difference")
    drawn = chart(
        "Derivative of sin(t) against cos(t)",
        panel("time / s", "derivative / (1/s)", *both),
        panel("time / s", "error, backward / (1/s)", curve(time[1:], error)),
        panel("time / s", "error, bench / (1/s)", curve(time[kept], error_of_bench)),
    )
    return TaskResult((findings,), numbers, (drawn,))


def signals(name: str, title: str, recordings: LabRecordings) -> TaskResult:
    """Tasks 5 and 7: angle, speed, acceleration and torque of a recording one above the other, and how far they reach.

    They are drawn of a recording that cannot be of the axis, too, for what is wrong with it to be seen.
    """
    run = recordings.run(name)
    shown = {
        "angle φ / rad": run.angle,
        "speed ω / (rad/s)": run.velocity,
        "acceleration α / (rad/s²)": run.acceleration,
        "torque M / (N·m)": run.torque,
    }
    drawn = chart(title, *(panel("time / s", label, curve(run.time, values)) for label, values in shown.items()))
    try:
        recordings.sound(name)
    except InputError as reason:
        return TaskResult(charts=(drawn,), reason=reason)
    findings = (
        f"{run.time.size} samples, one each {run.sample_period * 1e3:.4g} ms, {run.time[-1]:.3g} s.",
        "The course asks for four graphs and names three: speed, acceleration and torque. The fourth here is the "
        "angle, which shows how far the disk turns and that the motion comes back.",
        *run.notes,
    )
    numbers = (
        Number("largest speed", float(np.abs(run.velocity).max()), "rad/s"),
        Number("largest acceleration", float(np.abs(run.acceleration).max()), "rad/s²"),
        Number("largest torque", float(np.abs(run.torque).max()), "N·m"),
    )
    return TaskResult(findings, numbers, (drawn,))


def half_width(value: float, std_error: float, name: str, run: LabRun) -> float:
    """Half width of 95 % of a quantity of a balance, in its unit: by noise, and by what another filter makes of it.

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
            'or turn one of them by a rig.toml beside it with [trace.columns] current = "-name of its column [unit]"',
        )


def load_inertia(
    inertia: float, half: float, recordings: LabRecordings, true: float | None
) -> tuple[list[Number], list[str]]:
    """J_load = J - J_motor beside the theory of the disk, as far as the rig tells them, and what is to be said of it.

    Args:
        inertia, half: J, and within how much it is known - kg*m**2.
        recordings: whose rig has the rotor's inertia and the disk's geometry.
        true: J of a simulated axis - kg*cm**2.
    """
    rig, sources = recordings.rig, recordings.sources
    rotor, theory = rig.motor.rotor_inertia, rig.load.disk_inertia if rig.load else None
    if rotor is None:
        return [], [f"J_load = J - J_motor is left open: {rig.source} gives no motor.rotor_inertia."]
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
    """Task 6: alpha_max, J from samples with |alpha| >= alpha_max/4, J_load = J - J_motor beside theory.

    Raises UndeterminedError where the axis never accelerates, or torque and acceleration oppose each other.
    """
    run = recordings.without_friction
    inertia, largest, taken = mean_inertia(run.acceleration, run.torque)
    require_positive(inertia)
    true = run.true("moment_of_inertia", KG_CM2)
    ratio = run.torque[taken] / run.acceleration[taken]
    half = half_width(inertia, float(np.std(ratio)) / math.sqrt(ratio.size), "inertia", run)
    loads, of_load = load_inertia(inertia, half, recordings, true)
    modelled = inertia * run.acceleration
    left = rms((run.torque - modelled)[taken])
    findings = (
        f"{taken.sum()} of {taken.size} samples accelerate at alpha_max/4 or more; J is the mean of M/α over them.",
        "In which unit? N·m over rad/s² is N·m·s² = kg·m², as the radian counts as 1; 1 kg·m² = 10⁴ kg·cm².",
        f"J·α compared with M: they leave {left:.3g} N·m RMS, {left / rms(run.torque[taken]):.1%} of the torque of "
        f"these samples. M/α itself scatters by {float(np.std(ratio) / abs(np.mean(ratio))):.1%} from sample to "
        "sample, most of it noise that the difference makes of the speed.",
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
    """A modelled torque (n,) - N*m - over the measured one, and what it leaves; `symbol` stands for it there."""
    measured, over_it = curve(run.time, run.torque, "measured torque M", "wide"), curve(run.time, modelled, name)
    return chart(
        title,
        panel("time / s", "torque / (N·m)", measured, over_it),
        panel("time / s", f"M - {symbol} / (N·m)", curve(run.time, run.torque - modelled)),
    )
