"""Gaps of torque and velocity, on both recordings, after each accepted effect."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.diagnosis.add import Added
from bench.diagnosis.recordings import Recordings
from bench.fit.fit import Fit
from bench.fit.stored import Balance
from bench.plant.measured_motion import measured_velocity
from bench.trace.noise import white_noise


@dataclass(frozen=True)
class Gap:
    """RMS gap before and after the effects were added, on both recordings, against the noise floor.

    Attributes:
        unit: of all numbers.
        noise_floor: expected RMS from sensor noise alone.
        identify, holdout: (before, after) over all rows; None if not available.
        judged: share of the rows that the verdict is based on, and the gap on them; None if it is all rows.
    """

    unit: str
    noise_floor: float
    identify: tuple[float, float] | None
    holdout: tuple[float, float] | None
    judged: tuple[float, float] | None = None


@dataclass(frozen=True)
class Shrunk:
    """Gaps after one addition to the model.

    Attributes:
        effect: added last; empty for the bare axis.
        torque: of the recording, and of the holdout where there is one - N*m (N).
        velocity: the same - rad/s (m/s); nan if not available.
    """

    effect: str
    torque: tuple[float, ...]
    velocity: tuple[float, ...]


@dataclass(frozen=True)
class Course:
    """One recording over time, with the residuals of the model after each addition.

    Attributes:
        name: `recording` or `holdout`.
        origin: of it.
        time: s - (n,).
        velocity: as measured - rad/s (m/s) - (n,).
        velocity_left: measured less simulated, for each step (n,), nan outside the model; None without a model, or
            if it diverged.
        rows: index into the samples of each row of the torque balance (m,).
        torque: as measured, filtered - N*m (N) - (m,).
        torque_left: measured less modelled, for each step (m,).
    """

    name: str
    origin: str
    time: Array
    velocity: Array
    velocity_left: tuple[NDArray[np.float32] | None, ...]
    rows: NDArray[np.int64]
    torque: Array
    torque_left: tuple[Array, ...]


def courses(recordings: Recordings, added: Added) -> tuple[Course, ...]:
    """The recording, and the holdout where there is one, beside the bare axis and the model after each addition."""
    laid_out = [rows for rows in (recordings.rows, recordings.holdout_rows) if rows is not None]
    balances = [Balance.of(stage.fitted).repeating(added.repeats) for stage in added.extension.stages]
    found = []
    for rows, recorded in zip(laid_out, added.recorded, strict=True):
        velocity = [added.gaps.residual(stage, recorded) for stage in added.extension.stages]
        if added.refined.gap is not None and added.refined.model is not None:
            (simulated,) = added.gaps.velocities([added.refined.model], [recorded])
            velocity[-1] = None if simulated is None else recorded.residual(simulated)
        torque = tuple(balance.left(rows) for balance in balances)
        measured = measured_velocity(recorded.trace)
        along = recorded.name, recorded.trace.origin, recorded.trace.time, measured, tuple(velocity)
        found.append(Course(*along, rows.samples(), rows.effort, torque))
    return tuple(found)


def shrinking(added: Added, shown: Sequence[Course]) -> list[Shrunk]:
    """Gaps of the bare axis and after each addition, the last one as it was kept."""
    return [
        Shrunk(
            stage.effect,
            tuple(rms(course.torque_left[k]) for course in shown),
            tuple(_rms_known(course.velocity_left[k]) for course in shown),
        )
        for k, stage in enumerate(added.extension.stages)
    ]


def _rms_known(left: NDArray[np.float32] | None) -> float:
    """RMS over the samples that a model covers; nan without a model."""
    return math.nan if left is None else rms(left[np.isfinite(left)].astype(np.float64))


def torque_gap(steps: list[Shrunk], whole: Fit, unit: str) -> Gap:
    """Of all effects together, over all rows; beside it what is left on those that judge the fit, where not all do."""
    pairs = list(zip(steps[0].torque, steps[-1].torque, strict=True))
    judged = None if whole.determined.all() else (float(whole.determined.mean()), whole.rms)
    return Gap(unit, whole.floor, pairs[0], pairs[1] if len(pairs) > 1 else None, judged)


def velocity_gap(recordings: Recordings, steps: list[Shrunk]) -> Gap:
    """Of all effects together; None where MuJoCo cannot have the model or a simulation diverged."""
    pairs = [
        pair if all(map(math.isfinite, pair)) else None
        for pair in zip(steps[0].velocity, steps[-1].velocity, strict=True)
    ]
    floor = white_noise(measured_velocity(recordings.trace))
    unit = recordings.rig.axis_kind.speed_unit
    return Gap(unit, floor, pairs[0], pairs[1] if len(pairs) > 1 else None)
