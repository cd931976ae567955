"""The course's methods, with numpy alone: the report, the grades and the scripts to hand in call these functions.

Signals are (n,) in SI. The file is copied next to the scripts, so it imports nothing of the bench.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Signal = NDArray[np.float64]
#: Differences in a mean; an even number, so that the mean is late by whole samples.
WIDTH = 4
#: The mean is late by (WIDTH - 1)/2 samples, the backward difference by half of one.
DELAY = WIDTH // 2
#: Slower samples are dropped - rad/s; J comes from samples above this share of the largest acceleration.
LEAST_SPEED, ACCELERATION_SHARE = 20.0, 0.25
#: Samples of less torque are dropped - N*m; the run-up starts above this share of the peak, 3.0 N*m in the lab.
LEAST_TORQUE, FULL_SHARE = 0.2, 3.0 / 3.5
#: Speeds of the course's table - rpm, and samples that belong to one: within this of it - rad/s.
SPEEDS, HALF_BIN = (0.0, 1000.0, 2000.0, 2100.0, 3000.0, 4000.0, 5000.0), 5.0
#: Beyond this share of the highest speed the drive's speed control may reduce the torque.
STILL_RISING = 0.97
RPM, KG_CM2 = 30.0 / np.pi, 1e4


def parabola(y: Signal, z: Signal) -> tuple[Signal, float]:
    """Task 1: a, b, c of z = a*y**2 + b*y + c by least squares, and the remaining quadratic error E."""
    columns = np.column_stack([y**2, y, np.ones_like(y)])
    theta = np.asarray(np.linalg.lstsq(columns, z, rcond=None)[0], dtype=np.float64)
    return theta, float(np.sum((z - columns @ theta) ** 2))


def num_derivative(u: Signal, period: float) -> Signal:
    """Task 2: u'[k] = (u[k] - u[k-1])/T, first value 0."""
    return np.diff(u, prepend=u[:1]) / period


def mean_inertia(alpha: Signal, torque: Signal) -> tuple[float, float, NDArray[np.bool_]]:
    """Task 6: J as the mean of M/alpha over |alpha| >= alpha_max/4, alpha_max, and which samples these are."""
    largest = float(np.abs(alpha).max())
    hard = np.abs(alpha) >= ACCELERATION_SHARE * largest
    return float(np.mean(torque[hard] / alpha[hard])), largest, hard


def filtered_acceleration(alpha: Signal, width: int = WIDTH, delay: int = DELAY) -> tuple[Signal, slice]:
    """Task 8: the mean of `width` backward differences, and the samples of the other signals it belongs to (t_sync).

    It is late by width/2 samples, being (omega[k] - omega[k-width])/(width*T); `delay` samples are taken back.
    """
    mean = np.convolve(alpha[1:], np.full(width, 1.0 / width), mode="valid")
    return mean, slice(width - delay, width - delay + mean.size)


def fast_samples(omega: Signal) -> NDArray[np.bool_]:
    """Tasks 8 and 9: which samples of a recording are on t_sync and fast enough that friction is a constant."""
    fast = np.abs(omega) >= LEAST_SPEED
    fast[: WIDTH - DELAY] = fast[omega.size - DELAY :] = False
    return fast


def kept_samples(torque: Signal, peak: float) -> NDArray[np.bool_]:
    """Task 10: which samples of a run-up remain; all are False if it never reaches full torque. `peak` is in N*m."""
    full = torque > FULL_SHARE * peak
    return (torque >= LEAST_TORQUE) & np.logical_or.accumulate(full)


def torque_at_speeds(omega: Signal, torque: Signal) -> Signal:
    """Task 10: M_max at SPEEDS, the median within HALF_BIN on the way up; NaN without a sample of the motor's own."""
    up = slice(0, int(np.argmax(omega)) + 1)
    motors = omega[up] < STILL_RISING * omega.max()
    near = (motors & (np.abs(omega[up] - speed / RPM) <= HALF_BIN) for speed in SPEEDS)
    return np.array([np.median(torque[up][samples]) if samples.any() else np.nan for samples in near])
