"""A motion by samples of its speed, as a recording has it or a person gives it, for a drive to follow."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import gaussian_filter1d

from bench.arrays import Array
from bench.errors import InputError
from bench.plant.drive import References
from bench.trace.trace import Trace

#: Width by which a measured speed is smoothed before a drive is told to follow it - s.
SMOOTHED = 5e-3
#: In which a motion comes from rest, or to it, where its recording does not - s.
RAMP = 0.1


class Sampled:
    """A motion by its speed at some times, between which it has no overshoot; it starts and ends at rest.

    Args:
        time: (n,) rising - s.
        speed: (n,) - rad/s (m/s).
    """

    def __init__(self, time: Array, speed: Array) -> None:
        time = np.concatenate([[time[0] - RAMP], time, [time[-1] + RAMP]]) - (time[0] - RAMP)
        self._speed = PchipInterpolator(time, np.concatenate([[0.0], speed, [0.0]]))
        self._position, self._acceleration = self._speed.antiderivative(), self._speed.derivative()
        self.duration = float(time[-1])
        self.distance = float(self._position(self.duration))
        self.top = float(np.abs(speed).max())

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """Position, speed, acceleration at times within the duration - rad, rad/s, rad/s**2."""
        return self._position(time), self._speed(time), self._acceleration(time)


def motion_of(recording: Trace) -> Sampled:
    """The motion that a recording's drive was told to make; where that is not recorded, the one that it made."""
    time = recording.time
    if "velocity_reference" in recording:
        speed = recording["velocity_reference"]
    elif "position_reference" in recording:
        speed = np.gradient(recording["position_reference"], time)
    else:
        measured = recording["velocity"] if "velocity" in recording else np.gradient(recording["position"], time)
        speed = gaussian_filter1d(np.interp(time, *_known(time, measured)), SMOOTHED / recording.sample_period)
    return Sampled(*_known(time, speed))


def _known(time: Array, values: Array) -> tuple[Array, Array]:
    there = np.isfinite(values)
    return time[there], values[there]


def followed(motion: Trace | ArrayLike, step: float, period: float) -> References:
    """What a drive is told to follow along a recording, or along speeds - rad/s (m/s) - (n,).

    Args:
        motion: the recording, or speeds.
        step: between speeds - s.
        period: of the drive's ticks - s.

    Raises:
        InputError: speeds that are not some numbers in a row.
    """
    if isinstance(motion, Trace):
        sampled = motion_of(motion)
    else:
        speed = np.asarray(motion, dtype=np.float64)
        if speed.ndim != 1 or speed.size < 2 or not np.isfinite(speed).all():
            raise InputError(
                "profile", f"found an array of shape {speed.shape}", "allowed: two or more finite speeds, (n,)"
            )
        sampled = Sampled(step * np.arange(speed.size, dtype=np.float64), speed)
    time = period * np.arange(int(sampled.duration / period + 1e-9) + 1, dtype=np.float64)
    return References(time, *sampled.at(time))
