"""One recording of the course in SI, as the tasks take it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from bench.arrays import Array
from bench.course.axis import torque_constant
from bench.errors import InputError, UndeterminedError
from bench.fit.lab import backward_difference
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: A shorter recording is no run of the course.
LEAST = 100
#: Backward differences that the filter takes the mean of; an even number, so that it is late by whole samples.
WIDTH = 4
#: The mean is late by (WIDTH - 1)/2 samples, the backward difference by half of one.
DELAY = WIDTH // 2


@dataclass(frozen=True)
class LabRun:
    """One recording, signals (n,).

    Attributes:
        time: s.
        velocity: omega - rad/s.
        current: Iq - A.
        acceleration: alpha, backward difference of the speed - rad/s**2.
        torque: kT(Iq)*Iq - N*m.
        angle: from the start on - rad; as recorded, else the integral of the speed.
        sample_period: s.
        truth: values of the simulated axis by their names - SI; empty for a real one.
        notes: what was passed over to get it.
        missing: share of the recording that holes cut off, and where the first is - s.
    """

    time: Array
    velocity: Array
    current: Array
    acceleration: Array
    torque: Array
    angle: Array
    sample_period: float
    truth: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    missing: tuple[float, float] = (0.0, 0.0)

    def true(self, name: str, factor: float = 1.0) -> float | None:
        """True value of a quantity times a factor that changes its unit; None on a real axis."""
        return self.truth[name] * factor if name in self.truth else None

    def at(self, samples: NDArray) -> LabRun:
        """Some samples of it alone, chosen by (n,)."""
        signals = ("time", "velocity", "current", "acceleration", "torque", "angle")
        return replace(self, **{name: getattr(self, name)[samples] for name in signals})


def made_run(velocity: Array, current: Array, sample_period: float, rig: Rig, angle: Array | None = None) -> LabRun:
    """Run of a speed - rad/s - and a current - A - (n,), a period - s - apart; InputError without a torque constant."""
    return LabRun(
        time=sample_period * np.arange(velocity.size, dtype=np.float64),
        velocity=velocity,
        current=current,
        acceleration=backward_difference(velocity, sample_period),
        torque=torque_constant(rig).torque(current),
        angle=cumulative_trapezoid(velocity, dx=sample_period, initial=0.0) if angle is None else angle,
        sample_period=sample_period,
    )


def filtered_acceleration(run: LabRun, width: int = WIDTH, delay: int = DELAY) -> tuple[Array, slice]:
    """alpha_filt, the mean of `width` backward differences, and the samples of the other signals it belongs to.

    It comes WIDTH/2 samples late, being (u[k] - u[k-WIDTH])/(WIDTH*T); set back by them it is in step with the rest.

    Args:
        run: that was recorded.
        width, delay: differences in a mean, and samples by which it is set back.
    """
    mean = np.convolve(run.acceleration[1:], np.full(width, 1.0 / width), mode="valid")
    first = width - delay  # the mean comes with its last difference, that of sample `width`
    return mean, slice(first, first + mean.size)


def run_of(trace: Trace, rig: Rig, truth: Mapping[str, float] | None = None, notes: tuple[str, ...] = ()) -> LabRun:
    """Signals of a recording, its longest stretch without a hole.

    Raises:
        UndeterminedError: fewer than LEAST samples.
        InputError: no velocity or current in it, a linear axis, or no torque constant in the rig.
    """
    if not trace.axis_kind.turns:
        allowed = "allowed: a rotary one, velocity in deg/s, rad/s or rpm"
        raise InputError(trace.origin, f"found a {trace.axis_kind.name} axis", allowed)
    part = max(trace.segments, key=lambda segment: segment.stop - segment.start)
    velocity, current = trace["velocity"][part], trace["current"][part]
    if velocity.size < LEAST:
        reason = f"{trace.origin} has {velocity.size} samples in a row, {LEAST} are the least"
        raise UndeterminedError("motion", reason, "the whole run without holes")
    angle = trace["position"][part] - trace["position"][part.start] if "position" in trace else None
    run = made_run(velocity, current, trace.sample_period, rig, angle)
    if len(trace.segments) > 1:
        notes += (f"The recording has holes; of {len(trace)} samples the longest {velocity.size} in a row are taken.",)
    hole = float(trace.time[min(segment.stop for segment in trace.segments) - 1])
    return replace(run, truth=truth or {}, notes=notes, missing=(1.0 - velocity.size / len(trace), hole))
