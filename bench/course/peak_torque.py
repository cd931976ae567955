"""Torque over speed: the fastest run-up against the datasheet's peak curve (task 10), and the operating range.

The corner is the speed at which torque starts to decline, as full voltage no longer drives peak current:

    L*dIq/dt + R*Iq = U - Ke*omega  beyond it,  so  Iq = top*(omega_0 - omega)/(omega_0 - omega_c), late by tau = L/R

At the corner itself Iq is constant, dIq/dt = 0: U = R*top + Ke*omega_c is valid with inductance and without. So
inductance moves what follows, the fall, and not the corner: it keeps the current up for about tau, in which speed
rises by alpha*tau.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from bench.arrays import NORMAL95, Array
from bench.course.axis import MAINS
from bench.course.methods import FULL_SHARE, HALF_BIN, RPM, SPEEDS, STILL_RISING, kept_samples, torque_at_speeds
from bench.course.recordings import LabRecordings, LabRun
from bench.course.result import Number, TaskResult, chart, curve, panel
from bench.effects.effect import lagged
from bench.errors import UndeterminedError
from bench.report.document import Table, table
from bench.report.drive import in_range
from bench.rig.limits import peak_curve
from bench.rig.rig import Rig

#: Stretch of the falling current, in shares of its top, that the line is fitted to.
FROM, TO = 0.9, 0.5
#: The top is the median of samples above this share of the largest.
TOP = 0.95
#: Time constant that the search for it starts from - s, and more than a winding's.
TYPICAL, TOO_LATE = 2e-3, 10e-3
#: Points of the model a sample: the current bends between two of them.
FINER = 8


@dataclass(frozen=True)
class Decline:
    """How the current falls beyond the corner.

    Attributes:
        corner: speed at which it starts to - rad/s.
        no_load: speed at which it would end, as the winding was during the run - rad/s.
        lag: tau, by which it comes late, L/R - s.
        half: the corner is known within so much - rad/s.
    """

    corner: float
    no_load: float
    lag: float
    half: float


def decline(velocity: Array, current: Array, sample_period: float) -> Decline:
    """Corner, end and lag of the fall, by least squares on the current from its top to half of it.

    Args:
        velocity, current: (n,) of one run-up, evenly sampled - rad/s, A.
        sample_period: s.

    Raises:
        UndeterminedError: the current does not fall to half while the axis accelerates, or later than L/R has it.
    """
    top, high, slope, offset = _fall(velocity, current)
    below = np.flatnonzero((np.arange(current.size) > high[-1]) & (current < TO * top))
    stopped = np.flatnonzero(velocity >= STILL_RISING * velocity.max())
    ends = [int(found[0]) for found in (below, stopped) if found.size]
    part = slice(int(high[0]), min(ends, default=current.size))
    speed, measured = velocity[part], current[part]
    corner, no_load = (top - offset) / slope, -offset / slope
    between = np.interp(np.arange((speed.size - 1) * FINER + 1) / FINER, np.arange(speed.size), speed)

    def unexplained(theta: Array) -> Array:
        corner, no_load, lag = theta
        quasi_static = np.minimum(top, top * (no_load - between) / (no_load - corner))
        step = sample_period / FINER
        late = lagged(quasi_static, lag, step) if lag > 1e-6 * step else quasi_static
        return late[::FINER] - measured

    start, middle = np.array([corner, no_load, TYPICAL]), 0.5 * (corner + no_load)
    bounds = [0.0, middle, 0.0], [middle, 10.0 * no_load, 1.0]
    found = least_squares(unexplained, start, bounds=bounds, x_scale=start, xtol=1e-12, ftol=1e-12, gtol=1e-12)
    if found.x[2] > TOO_LATE:
        reason = f"the current falls {1e3 * found.x[2]:.0f} ms late, and L/R of a winding is a few: it was filtered"
        raise UndeterminedError("corner speed", reason, "speed and current as the drive has them, without a filter")
    variance = found.fun @ found.fun / max(found.fun.size - 3, 1) * np.linalg.pinv(found.jac.T @ found.jac)[0, 0]
    return Decline(*found.x.tolist(), half=NORMAL95 * math.sqrt(variance))


def _fall(velocity: Array, current: Array) -> tuple[float, NDArray[np.int64], float, float]:
    """Top of the current - A - and the samples there; slope - A*s/rad - and offset - A - of its fall over speed."""
    largest = float(current.max())
    high = np.flatnonzero(current > TOP * largest)
    falling = np.arange(current.size) > high[-1]
    falling &= (current < FROM * largest) & (current > TO * largest) & (velocity < STILL_RISING * velocity.max())
    speeds = velocity[falling]
    if speeds.size < 3 or np.ptp(speeds) <= 0.0:
        reason = "the current does not fall from its top to half of it as speed rises"
        raise UndeterminedError("corner speed", reason, "a run-up with full torque to close to the no-load speed")
    slope, offset = np.polyfit(speeds, current[falling], 1).tolist()
    return float(np.median(current[high[0] : high[-1] + 1])), high, slope, offset


def run_up(run: LabRun, rig: Rig) -> tuple[LabRun, Decline]:
    """Samples of task 10, and corner and decline of the run-up from its first full torque on.

    Raises UndeterminedError where it never reaches full torque, and as `decline`.
    """
    kept = kept_samples(run.torque, rig.motor.peak_torque or 0.0)
    if not kept.any():
        least = FULL_SHARE * (rig.motor.peak_torque or 0.0)
        reason = f"the torque never exceeds {least:.3g} N*m, it reaches {float(run.torque.max()):.3g} N*m"
        raise UndeterminedError("peak torque over speed", reason, "a run-up with the motor's full torque, forward")
    first = int(np.argmax(kept))
    return run.at(kept), decline(run.velocity[first:], run.current[first:], run.sample_period)


def datasheet_curve(rig: Rig) -> tuple[Array, Array]:
    """Corners of the peak curve at MAINS: speed - rad/s, torque - N*m."""
    curve = peak_curve(rig.motor, MAINS, rig.source)
    speed = np.array([0.0, curve.corner_speed, curve.no_load_speed])
    return speed, (rig.motor.peak_torque or 0.0) * curve.share(speed)


def over_speed(recordings: LabRecordings) -> TaskResult:
    """Draw the measured torque over the speed with the datasheet's curve, and list both at the drawing's speeds."""
    run, rig, sources = recordings.fastest, recordings.rig, recordings.sources
    kept, found = run_up(run, rig)
    speed, torque = kept.velocity * RPM, kept.torque
    limit, allowed = datasheet_curve(rig)
    corner, corner_of_datasheet = found.corner * RPM, float(limit[1]) * RPM
    measured = dict(zip(SPEEDS, torque_at_speeds(kept.velocity, torque).tolist(), strict=True))
    sheet = dict(zip(SPEEDS, np.interp(SPEEDS, limit * RPM, allowed).tolist(), strict=True))
    numbers = (
        Number("peak torque", float(torque.max()), "N·m", rig.motor.peak_torque if run.truth else None),
        Number("measured corner", corner, "rpm", run.true("corner_speed", RPM), half=found.half * RPM),
        Number("datasheet's corner", corner_of_datasheet, "rpm", source=sources("motor", "peak_curves")),
    )
    source = sources("motor", "peak_torque")
    read = [Number(f"M_max at {n:.0f} rpm, datasheet", value, "N·m", source=source) for n, value in sheet.items()]
    read += [Number(f"M_max at {n:.0f} rpm", value, "N·m") for n, value in measured.items() if math.isfinite(value)]
    findings = (
        f"The torque starts to decline at {corner:.0f} rpm, {corner - corner_of_datasheet:+.0f} rpm from the "
        "datasheet's corner; task 11 gives the reason. It is found by least squares on the current from its top to "
        "half of it: constant, then falling in proportion to speed with a lag, as the motor's circuit has it.",
        *run.notes,
        *_speeds_findings(kept),
        *_end_findings(kept, found, measured),
    )
    curves = [
        curve(speed, torque, "measured", "dots"),
        curve(limit * RPM, allowed, f"datasheet, {MAINS:g} V", "dashes"),
        curve(np.array([corner]), np.interp([corner], speed, torque), "corner", "large dots"),
    ]
    axes = panel("speed n / rpm", "torque M / (N·m)", *curves)
    shown = (chart("Task 10: peak torque", axes),)
    return TaskResult(findings, numbers, shown, tables=(_at_speeds(sheet, measured),), tabled=tuple(read))


def _at_speeds(sheet: Mapping[float, float], measured: Mapping[float, float]) -> Table:
    """The course's table in two lines, and the measured torque below it."""
    rows = [
        (f"M_max of the datasheet at {MAINS:g} V / (N·m)", *(f"{value:.3g}" for value in sheet.values())),
        ("M_max measured / (N·m)", *(f"{value:.3g}" if math.isfinite(value) else "-" for value in measured.values())),
    ]
    return table("Peak torque at the speeds of the drawing", ("n / rpm", *(f"{n:.0f}>" for n in SPEEDS)), rows)


def _speeds_findings(kept: LabRun) -> Iterator[str]:
    """Where the samples of the slowest entry lie: the run-up passes full torque only when it already turns."""
    near = np.abs(kept.velocity[: int(np.argmax(kept.velocity)) + 1]) <= HALF_BIN
    if near.any():
        speeds = kept.velocity[: near.size][near] * RPM
        yield (
            f"M_max at 0 rpm is the median of {near.sum()} samples from {speeds.min():.0f} to {speeds.max():.0f} rpm: "
            "the axis turns already when the torque reaches its peak."
        )


def _end_findings(kept: LabRun, found: Decline, measured: Mapping[float, float]) -> Iterator[str]:
    """What ends the run before the no-load speed: the drive's set speed, which the axis then keeps."""
    top = float(kept.velocity.max())
    if top <= 0.99 * found.no_load:
        yield (
            f"The tail above {STILL_RISING * top * RPM:.0f} rpm is not the motor's limit. The drive was set to about "
            f"{top * RPM:.0f} rpm: as the axis gets there its speed control takes the torque back, to "
            f"{float(kept.torque[kept.velocity > STILL_RISING * top].min()):.2g} N·m, where the winding would still "
            f"give it up to {found.no_load * RPM:.0f} rpm."
        )
    if missing := [f"{n:.0f}" for n, value in measured.items() if not math.isfinite(value)]:
        speeds = ", ".join(missing)
        yield f"At {speeds} rpm the motor's torque was not measured: the drive's set speed ends the run-up."


def operating_range(recordings: LabRecordings) -> TaskResult:
    """The recording with friction in the speed-torque diagram, and its reserve."""
    run = recordings.with_friction
    found = in_range(recordings.rig, run.velocity, run.torque, "recording with friction")
    numbers = tuple(Number(name, value, unit) for name, (value, unit) in found.numbers.items())
    return TaskResult(found.findings, numbers, (found.chart,), title=found.chart.title)
