"""A recording of the lab in SI: speed and current as recorded, acceleration and torque as the course makes them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import cumulative_trapezoid

from bench.arrays import Array
from bench.course.result import Chart, Curve, Panel
from bench.course.rig import torque_constant
from bench.errors import InputError, UndeterminedError
from bench.fit.lab import backward_difference
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: A shorter recording is no run of the course.
LEAST = 100


@dataclass(frozen=True)
class Run:
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
    """

    time: Array
    velocity: Array
    current: Array
    acceleration: Array
    torque: Array
    angle: Array
    sample_period: float
    truth: Mapping[str, float] = field(default_factory=dict)

    def true(self, name: str, factor: float = 1.0) -> float | None:
        """True value of a quantity times a factor that changes its unit; None on a real axis."""
        return self.truth[name] * factor if name in self.truth else None


def run_of(trace: Trace, rig: Rig, truth: Mapping[str, float] | None = None) -> Run:
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
    return Run(
        time=trace.time[part] - trace.time[part.start],
        velocity=velocity,
        current=current,
        acceleration=backward_difference(velocity, trace.sample_period),
        torque=torque_constant(rig).torque(current),
        angle=_angle(trace, part),
        sample_period=trace.sample_period,
        truth=truth or {},
    )


def _angle(trace: Trace, part: slice) -> Array:
    if "position" in trace:
        return trace["position"][part] - trace["position"][part.start]
    return cumulative_trapezoid(trace["velocity"][part], dx=trace.sample_period, initial=0.0)


def signals_chart(run: Run, title: str) -> Chart:
    """Angle, speed, acceleration and torque one above the other on one time axis."""
    signals = (
        ("angle φ / rad", run.angle),
        ("speed ω / (rad/s)", run.velocity),
        ("acceleration α / (rad/s²)", run.acceleration),
        ("torque M / (N·m)", run.torque),
    )
    return Chart(title, tuple(Panel("time / s", label, (Curve(run.time, values),)) for label, values in signals))


def extent(values: Array) -> float:
    """Largest magnitude."""
    return float(np.max(np.abs(values)))
