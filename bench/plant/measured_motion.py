"""The motion that a recording tells: measured position and velocity, in stretches without holes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.trace.trace import Trace


def stretches_of(trace: Trace) -> tuple[slice, ...]:
    """Stretches without holes that a model can be held to; a lone sample shows no motion."""
    return tuple(part for part in trace.segments if part.stop - part.start > 1)


def in_stretches(trace: Trace) -> NDArray[np.bool_]:
    """Samples at which a model held to a recording says something, (n,): those of `stretches_of`."""
    found = np.zeros(len(trace), dtype=np.bool_)
    for part in stretches_of(trace):
        found[part] = True
    return found


def measured_velocity(trace: Trace) -> Array:
    """Reported velocity, or the central difference of a reported position - rad/s (m/s) - (n,).

    A lone sample between holes has none of its own; it takes the mean speed between its neighbours.
    """
    if "velocity" in trace:
        return trace["velocity"]
    position, velocity = trace["position"], np.empty(len(trace))
    for part in trace.segments:
        if part.stop - part.start > 1:
            velocity[part] = np.gradient(position[part], trace.sample_period)
        else:
            around = [max(part.start - 1, 0), min(part.stop, len(trace) - 1)]
            velocity[part] = np.diff(position[around]) / np.diff(trace.time[around])
    return velocity


def measured_position(trace: Trace) -> Array:
    """Reported position, or the integral of a reported velocity from zero in each stretch - rad (m) - (n,)."""
    if "position" in trace:
        return trace["position"]
    position = np.full(len(trace), np.nan)
    for part in stretches_of(trace):
        position[part] = integrated(trace["velocity"][part], trace.sample_period)
    return position


def integrated(velocity: Array, sample_period: float) -> Array:
    """Position from zero, by the trapezoidal rule - rad (m) - (n,)."""
    return np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2.0) * sample_period])
