"""Motion of a load behind a dead zone, driven along the recorded motion of the motor.

    q_l'' = w_c**2*p + 2*d*w_c*p' - c*q_l, p - penetration beyond half the gap on either side; no contact within the gap

The load's acceleration times its inertia is the torque that the motor feels through the coupling. Per unit of load
inertia the motion depends on the gap - rad (m) -, the contact's frequency w_c - rad/s - and damping d, and on the rate
c - 1/s**2 - of a spring on the load's side.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.effects.effect import Signals

Array = NDArray[np.float64]

#: Steps of the integration per two radians of the contact's oscillation; semi-implicit Euler is stable below one.
STEPS_PER_RADIAN = 4.0


def load_accelerations(signals: Signals, shapes: Array) -> Array:
    """Accelerations of the load behind several dead zones - rad/s**2 (m/s**2) - (n, k).

    The load starts at rest with the motor, in the middle of the gap; samples hold the mean over the period around them.

    Args:
        signals: of the motor.
        shapes: (k, 4): gap, contact's frequency and damping, spring's rate.
    """
    half, frequency, damping, spring = 0.5 * shapes[:, 0], shapes[:, 1], shapes[:, 2], shapes[:, 3]
    period, count = signals.sample_period, signals.position.size
    substeps = max(1, int(np.ceil(period * frequency.max() * STEPS_PER_RADIAN / 2.0)))
    step = period / substeps
    ticks = np.arange((count - 1) * substeps + 1) / substeps
    angle = np.interp(ticks, np.arange(count), signals.position)
    speed = np.interp(ticks, np.arange(count), signals.velocity)
    stiffness, loss = frequency**2, 2.0 * damping * frequency
    position, velocity = np.full(half.size, angle[0]), np.full(half.size, speed[0])
    gained = np.empty((ticks.size, half.size))
    for k in range(ticks.size):
        ahead = angle[k] - position
        penetration = ahead - np.minimum(np.maximum(ahead, -half), half)
        push = stiffness * penetration + loss * (speed[k] - velocity) * (penetration != 0.0)
        gained[k] = push - spring * position
        velocity = velocity + step * gained[k]
        position = position + step * velocity
    summed = np.concatenate([np.zeros((1, half.size)), np.cumsum(gained, axis=0)])
    centre = np.arange(count) * substeps
    low, high = np.maximum(centre - substeps // 2, 0), np.minimum(centre + (substeps + 1) // 2, ticks.size)
    return (summed[high] - summed[low]) / (high - low)[:, None]
