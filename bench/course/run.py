"""One recording of the course in SI, as the tasks take it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.course.axis import torque_constant
from bench.course.methods import num_derivative
from bench.errors import InputError, UndeterminedError
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: A shorter recording is no run of the course.
LEAST = 100


@dataclass(frozen=True)
class LabRun:
    """One recording, signals (n,).

    Attributes:
        time: s.
        velocity: omega - rad/s.
        current: Iq - A.
        acceleration: alpha, backward difference of the speed - rad/s**2.
        torque: kT(Iq)*Iq - N*m.
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
    sample_period: float
    truth: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    missing: tuple[float, float] = (0.0, 0.0)

    def true(self, name: str, factor: float = 1.0) -> float | None:
        """True value of a quantity times a factor that changes its unit; None on a real axis."""
        return self.truth[name] * factor if name in self.truth else None

    def at(self, samples: NDArray) -> LabRun:
        """Some samples of it alone, chosen by (n,)."""
        signals = ("time", "velocity", "current", "acceleration", "torque")
        return replace(self, **{name: getattr(self, name)[samples] for name in signals})


def made_run(velocity: Array, current: Array, sample_period: float, rig: Rig) -> LabRun:
    """Run of a speed - rad/s - and a current - A - (n,), with a period - s -; InputError without a torque constant."""
    return LabRun(
        time=sample_period * np.arange(velocity.size, dtype=np.float64),
        velocity=velocity,
        current=current,
        acceleration=num_derivative(velocity, sample_period),
        torque=torque_constant(rig).torque(current),
        sample_period=sample_period,
    )


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
    run = made_run(velocity, current, trace.sample_period, rig)
    if len(trace.segments) > 1:
        notes += (f"The recording has holes; of {len(trace)} samples the longest {velocity.size} in a row are taken.",)
    hole = float(trace.time[min(segment.stop for segment in trace.segments) - 1])
    return replace(run, truth=truth or {}, notes=notes, missing=(1.0 - velocity.size / len(trace), hole))
