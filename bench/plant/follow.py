"""Let a model follow the references of a recording under the drive of its rig: prediction, nothing holds it.

The references of the recording are read between its samples: velocity by a cubic that is smooth in acceleration,
position by the integral of that, held to the recorded one. What the drive makes of them is to be compared with what it
made of them on the axis; see `bench.plant.soft_tracking` for a model that is held to the recording.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.errors import InputError
from bench.plant.axis_model import AxisModel
from bench.plant.drive import Cascade
from bench.plant.plant import Plant
from bench.plant.references import References
from bench.plant.run import run
from bench.plant.sensing import reported_states
from bench.rig.rig import Rig
from bench.trace.trace import Trace


@dataclass(frozen=True)
class Followed:
    """What a model under its drive reports at the samples of a recording, (n,) each.

    Attributes:
        position: rad (m).
        velocity: rad/s (m/s).
        effort: reported torque, of the tick that begins with the sample - N*m (N).
    """

    position: Array
    velocity: Array
    effort: Array


def follow_references(model: AxisModel, trace: Trace, rig: Rig) -> Followed:
    """Run a model along the references of a recording without holes.

    Args:
        model: with effects.
        trace: with `velocity_reference` or `position_reference`, at rest at its start.
        rig: with `[drive]`.

    Raises:
        InputError: no references, holes, a rig without drive, or samples that are no multiple of its ticks.
        SimulationError: the simulation diverged.
    """
    cascade = Cascade.from_rig(rig)
    if len(trace.segments) > 1:
        raise InputError(trace.origin, f"found {len(trace.segments) - 1} holes", "allowed: a recording without holes")
    stride = round(trace.sample_period / cascade.control_period)
    if stride < 1 or abs(stride * cascade.control_period / trace.sample_period - 1.0) > 1e-3:
        raise InputError(
            trace.origin,
            f"found samples every {trace.sample_period:g} s",
            f"allowed: a multiple of the control period of {cascade.control_period:g} s",
        )
    plant = Plant.of(model, cascade)
    states = reported_states(plant.model, run([plant], [references_of(trace, cascade.control_period, stride)]))
    rows = slice(None, None, stride)
    return Followed(states.position[rows, 0], states.velocity[rows, 0], states.torque[rows, 0])


def references_of(trace: Trace, period: float, stride: int) -> References:
    """References of a recording at the drive's ticks, `stride` of which make a sample.

    Raises:
        InputError: the recording holds none.
    """
    from scipy.interpolate import CubicSpline  # 0.1 s, which only the drive's own loop has to pay

    ticks: Array = period * np.arange((len(trace) - 1) * stride + 1, dtype=np.float64)
    samples = ticks[::stride]
    if "velocity_reference" in trace:
        velocity = CubicSpline(samples, trace["velocity_reference"])
        position = velocity.antiderivative()
        offset = float(trace["position"][0]) if "position" in trace else 0.0
        if "position_reference" in trace:
            recorded = trace["position_reference"]
            slow = CubicSpline(samples, recorded - position(samples))(ticks)
            return References(ticks, position(ticks) + slow, velocity(ticks), velocity(ticks, 1))
        return References(ticks, position(ticks) + offset, velocity(ticks), velocity(ticks, 1))
    if "position_reference" in trace:
        position = CubicSpline(samples, trace["position_reference"])
        return References(ticks, position(ticks), position(ticks, 1), position(ticks, 2))
    raise InputError(trace.origin, "holds no references", "allowed: velocity_reference or position_reference")
