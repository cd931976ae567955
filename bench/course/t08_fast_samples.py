"""Task 8: filtered acceleration, and the samples that are fast enough for the friction model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.course.result import Chart, Curve, Number, Panel, Task
from bench.course.run import Run
from bench.errors import UndeterminedError
from bench.fit.lab import LEAST_SPEED
from bench.trace.filter import GaussianFilter

KEY, TITLE = "8", "Filtered acceleration, slow samples removed"

#: Backward differences that the filter takes the mean of; an even number, so that it is late by whole samples.
WIDTH = 4
#: The mean is late by (WIDTH - 1)/2 samples, the backward difference by half of one.
DELAY = WIDTH // 2
#: Width of the filter by which lateness is measured, and samples drawn to each side of an edge.
SMOOTHING, EDGE = 5.0, 25


@dataclass(frozen=True)
class FastSamples:
    """What remains for least squares, signals (m,).

    Attributes:
        time: t_sync, at which the filtered acceleration and the other signals belong together - s.
        velocity: rad/s.
        acceleration: alpha_filt - rad/s**2.
        torque: N*m.
    """

    time: Array
    velocity: Array
    acceleration: Array
    torque: Array


def filtered_acceleration(run: Run) -> tuple[Array, slice]:
    """alpha_filt, the mean of WIDTH backward differences, and the samples of the other signals it belongs to.

    It comes DELAY samples late, being (u[k] - u[k-WIDTH])/(WIDTH*T); set back by them it is in step with the rest.
    """
    mean = np.convolve(run.acceleration[1:], np.full(WIDTH, 1.0 / WIDTH), mode="valid")
    return mean, slice(DELAY, DELAY + mean.size)


def acceleration_of_all(run: Run) -> Array:
    """alpha_filt in step with every sample, (n,); at the ends, where its mean is cut short, of what there is of it."""
    mean, synchronous = filtered_acceleration(run)
    alpha = np.gradient(run.velocity, run.sample_period)
    alpha[synchronous] = mean
    return alpha


def fast_samples(run: Run) -> FastSamples:
    """Samples with |omega| >= 20 rad/s.

    Raises:
        UndeterminedError: the recording is too short or too slow, or turns one way only.
    """
    least = f"a run that passes {LEAST_SPEED:g} rad/s in both directions"
    if run.time.size <= WIDTH + 1:
        raise UndeterminedError("inertia and friction", f"the recording has {run.time.size} samples", least)
    acceleration, synchronous = filtered_acceleration(run)
    fast: NDArray[np.bool_] = np.abs(run.velocity[synchronous]) >= LEAST_SPEED
    if not fast.any():
        raise UndeterminedError("inertia and friction", f"no sample is faster than {LEAST_SPEED:g} rad/s", least)
    columns = (run.time[synchronous], run.velocity[synchronous], acceleration, run.torque[synchronous])
    return FastSamples(*(column[fast] for column in columns))


def lateness(run: Run, late: int = 0) -> float:
    """By how much alpha_filt, `late` samples later than on t_sync, comes after the speed's own derivative - samples.

    Both are smoothed by one filter that is even in time, so noise and smoothing are alike in them. What is late by tau
    is alpha - tau*alpha', and tau its least-squares estimate.
    """
    mean, synchronous = filtered_acceleration(run)
    speed = run.velocity[synchronous.start + late : synchronous.stop + late]
    smooth = GaussianFilter(SMOOTHING * run.sample_period, run.sample_period)
    slope, bend = smooth(speed, 1, 2)
    behind = slope - smooth(mean[: speed.size], 0)[0]
    return float(behind @ bend / (bend @ bend) / run.sample_period)


def task(run: Run) -> Task:
    """Draw the remaining samples over the original ones, and alpha_filt over alpha."""
    kept = fast_samples(run)
    acceleration, synchronous = filtered_acceleration(run)
    # thousandths of a sample are rounding
    in_step, as_it_comes = (round(lateness(run, late), 3) + 0.0 for late in (0, DELAY))
    scatter = [float(np.std(np.diff(signal))) for signal in (run.acceleration, acceleration)]
    return Task(
        KEY,
        TITLE,
        (
            f"alpha_filt is the mean of {WIDTH} backward differences. It is {DELAY} samples late, half a sample of "
            "that from the difference itself; t_sync takes that back. Below 20 rad/s the sign of the speed is left "
            "out, as friction is no constant there.",
            f"Verified against the speed's own derivative, both smoothed by a filter that is even in time: on t_sync "
            f"alpha_filt comes {in_step:+.2f} samples after it, as the filter delivers it {as_it_comes:+.2f}. "
            "α itself is "
            "half a sample late, as the graph of one edge shows.",
        ),
        (
            Number("samples remaining", float(kept.time.size), "1"),
            Number("samples removed", float(run.time.size - kept.time.size), "1"),
            Number("alpha_filt late, on t_sync", in_step, "samples"),
            Number("alpha_filt late, as it comes", as_it_comes, "samples"),
            Number("step to step scatter of alpha", scatter[0], "rad/s²"),
            Number("step to step scatter of alpha_filt", scatter[1], "rad/s²"),
        ),
        (_remaining_chart(run, kept, acceleration, synchronous), _edge_chart(run, acceleration, synchronous)),
    )


def _remaining_chart(run: Run, kept: FastSamples, acceleration: Array, synchronous: slice) -> Chart:
    panels = (
        ("speed ω / (rad/s)", run.time, run.velocity, kept.velocity),
        ("filtered acceleration α / (rad/s²)", run.time[synchronous], acceleration, kept.acceleration),
        ("torque M / (N·m)", run.time, run.torque, kept.torque),
    )
    return Chart(
        "Task 8: remaining samples over the original ones",
        tuple(
            Panel(
                "t_sync / s",
                label,
                (Curve(time, all_, "original", "wide"), Curve(kept.time, rest, "remaining", "dots")),
            )
            for label, time, all_, rest in panels
        ),
    )


def _edge_chart(run: Run, acceleration: Array, synchronous: slice) -> Chart:
    """alpha and alpha_filt, all of them, and around the steepest change of the torque."""
    edge = int(np.argmax(np.abs(np.diff(acceleration)))) + DELAY
    near = slice(max(edge - EDGE, DELAY), min(edge + EDGE, run.time.size - DELAY))
    within = slice(near.start - DELAY, near.stop - DELAY)
    late = run.time[synchronous] + DELAY * run.sample_period
    whole = (
        Curve(run.time, run.acceleration, "α", "wide"),
        Curve(run.time[synchronous], acceleration, "α_filt on t_sync"),
    )
    close = (
        Curve(run.time[near], run.acceleration[near], "α, original", "wide"),
        Curve(run.time[near], acceleration[within], "α_filt on t_sync", "bold dots"),
        Curve(late[within], acceleration[within], "α_filt as it comes", "dashes"),
    )
    panels = (
        Panel("t_sync / s", "acceleration α / (rad/s²)", whole),
        Panel("t_sync / s, one edge", "acceleration α / (rad/s²)", close),
    )
    return Chart("Task 8: filtered acceleration over the original one", panels)
