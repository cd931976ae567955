"""Task 8: filtered acceleration, and the samples that are fast enough for the friction model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.errors import UndeterminedError
from bench.identify.lab import LEAST_SPEED
from bench.lab.result import Chart, Curve, Number, Panel, Task
from bench.lab.run import Run

KEY, TITLE = "8", "Filtered acceleration, slow samples removed"

#: Backward differences that the filter takes the mean of; an even number, so that it is late by whole samples.
WIDTH = 4
#: The mean is late by (WIDTH - 1)/2 samples, the backward difference by half of one.
DELAY = WIDTH // 2


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


def fast_samples(run: Run) -> FastSamples:
    """Samples with |omega| >= 20 rad/s.

    Raises:
        UndeterminedError: the recording is too short or too slow.
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


def task(run: Run) -> Task:
    """Draw the remaining samples over the original ones."""
    kept = fast_samples(run)
    acceleration, synchronous = filtered_acceleration(run)
    panels = (
        ("speed ω / (rad/s)", run.time, run.velocity, kept.velocity),
        ("filtered acceleration α / (rad/s²)", run.time[synchronous], acceleration, kept.acceleration),
        ("torque M / (N·m)", run.time, run.torque, kept.torque),
    )
    chart = Chart(
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
    scatter = [float(np.std(np.diff(signal))) for signal in (run.acceleration, acceleration)]
    return Task(
        KEY,
        TITLE,
        (
            f"alpha_filt is the mean of {WIDTH} backward differences. It is {DELAY} samples late, half a sample of "
            "that from the difference itself; t_sync takes that back. Below 20 rad/s the sign of the speed is left "
            "out, as friction is no constant there.",
        ),
        (
            Number("samples remaining", float(kept.time.size), "1"),
            Number("samples removed", float(run.time.size - kept.time.size), "1"),
            Number("step to step scatter of alpha", scatter[0], "rad/s²"),
            Number("step to step scatter of alpha_filt", scatter[1], "rad/s²"),
        ),
        (chart,),
    )
