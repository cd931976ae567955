"""Velocity filter lag: the reported velocity lags the motion.

    T*dv/dt + v = omega

T - time constant - s; v - reported velocity, omega - velocity of the motion - rad/s (m/s). v is what
is recorded; the drive has a velocity of its own, without the filter.
Source: W. Leonhard, Control of Electrical Drives (filtered speed feedback).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.signal import lfilter

from bench.effects.physics import Array, Axis, Number, Sensing
from bench.units import Quantity


class VelocityFilterLag(Sensing):
    """See the module."""

    name = "velocity_filter_lag"
    summary = "reported velocity lags the motion"
    quantities = (Quantity("time_constant", "T", "s", lower=0.0),)

    def null(self, axis: Axis) -> Mapping[str, Number]:
        """Where the effect is absent."""
        return {"time_constant": 0.0}

    def filtered(self, values: Mapping[str, float], velocity: Array, step: float) -> Array:
        """Exact for a velocity that changes linearly within the step; started where the velocity is."""
        decay, of_before, of_now = _weights(values["time_constant"], step)
        start = np.array([(1.0 - of_now) * velocity[0]])
        return lfilter([of_now, of_before], [1.0, -decay], velocity, zi=start)[0]

    def unfiltered(self, values: Mapping[str, float], velocity: Array, step: float) -> Array:
        """v + T*dv/dt by central differences: what holds a model to a recording needs no more."""
        return velocity + values["time_constant"] * np.gradient(velocity, step) if velocity.size > 1 else velocity


def _weights(time_constant: Number, step: float) -> tuple[Number, Number, Number]:
    """Weights of the reported velocity, and of the seen one before and after the step."""
    decay = np.exp(-step / time_constant)
    mean = time_constant / step * (1.0 - decay)
    return decay, mean - decay, 1.0 - mean


EFFECT = VelocityFilterLag()
