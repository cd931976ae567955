"""Motion of a load behind a dead zone, driven along the recorded motion of the motor.

    q_l'' = w_c**2*p + 2*d*w_c*p' - c*q_l,  p = (q_m - q_l) - clip(q_m - q_l, -g/2, g/2)

p - penetration of the contact, 0 within the gap g - rad (m); w_c - frequency of the contact - rad/s -, d its damping
ratio, both per unit of load inertia; c - rate of a spring on the load's side - 1/s**2. The contact's damping is an
impulse 2*d*w_c*dp, so it also acts while the contact opens.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.signals import Signals
from bench.trace.filter import Column

#: Steps of the integration per radian of the contact's oscillation: the trapezoidal rule errs by 1/(12*steps**2) of it.
STEPS_PER_RADIAN = 6.0
#: Windows that a recording is cut into, which are integrated side by side, and samples of the shortest.
WINDOWS, SHORTEST = 128, 60
#: Share of the gap to which a window's start agrees with the end of the window before.
CLOSED = 1e-5


def load_positions(angle: Array, sample_period: float, shapes: Array) -> Array:
    """Positions of the load behind several dead zones - rad (m) - (n, k).

    The motor moves along a cubic spline through its samples. The recording is cut into windows that are integrated side
    by side, each from where the one before it ended in the sweep before, until starts and ends agree: a contact forgets
    how it was entered, so few sweeps do. The load starts with the motor, in the middle of the gap.

    Args:
        angle: of the motor - rad (m) - (n,).
        sample_period: s.
        shapes: (k, 4): gap, contact's frequency and damping, spring's rate.
    """
    from scipy.interpolate import CubicSpline  # 0.15 s, which only a dead zone has to pay

    substeps = max(2, int(np.ceil(sample_period * shapes[:, 1].max() * STEPS_PER_RADIAN)))
    spline = CubicSpline(np.arange(angle.size), angle)
    length = max(SHORTEST, -(-(angle.size - 1) // WINDOWS))
    count, size = -(-(angle.size - 1) // length), len(shapes)
    fine = spline(np.minimum(np.arange(count * length * substeps + 1) / substeps, angle.size - 1.0))
    windows = fine[np.arange(length * substeps + 1)[:, None] + length * substeps * np.arange(count)]
    firsts = length * np.arange(count)
    position = np.repeat(angle[firsts][:, None], size, axis=1)
    velocity = np.repeat((spline(firsts, 1) / sample_period)[:, None], size, axis=1)
    found = np.empty((length, count, size))
    window, shape = (pairs.ravel() for pairs in np.indices((count, size)))
    while window.size:
        start = position[window, shape], velocity[window, shape]
        moved, last, speed = _run(windows, window, shapes[shape], start, sample_period / substeps)
        found[:, window, shape] = moved[substeps - 1 :: substeps]
        inside = window + 1 < count
        window, shape, last, speed = window[inside] + 1, shape[inside], last[inside], speed[inside]
        away = np.abs(last - position[window, shape])
        away = np.maximum(away, np.abs(speed - velocity[window, shape]) / shapes[shape, 1])
        position[window, shape], velocity[window, shape] = last, speed
        apart = away > CLOSED * shapes[shape, 0]
        window, shape = window[apart], shape[apart]
    samples = found.transpose(1, 0, 2).reshape(count * length, size)
    return np.concatenate([np.full((1, size), angle[0]), samples[: angle.size - 1]])


def _run(
    angles: Array, window: NDArray[np.intp], shapes: Array, start: tuple[Array, Array], step: float
) -> tuple[Array, Array, Array]:
    """Positions at the ends of all steps (steps, p), and the last position and velocity, of windows with shapes (p, 4).

    Trapezoidal rule, implicit where a step ends in contact.
    """
    gap, frequency, damping, spring = shapes.T
    above, below, half_step = 0.5 * gap, -0.5 * gap, 0.5 * step
    push = half_step * frequency**2 + 2.0 * damping * frequency
    resist = half_step * frequency**2 - 2.0 * damping * frequency
    implicit = push / (1.0 + half_step * push)
    explicit = resist / (1.0 + half_step * push)
    springs, pull = bool(spring.any()), step * spring
    position, velocity = start
    moved = np.empty((angles.shape[0] - 1, position.size))
    twist = angles[0][window] - position
    before = twist - np.minimum(np.maximum(twist, below), above)
    for k in range(moved.shape[0]):
        angle = angles[k + 1][window]
        ahead = position + step * velocity
        twist = angle - ahead
        after = twist - np.minimum(np.maximum(twist, below), above)
        impulse = np.where(after != 0.0, implicit * after + explicit * before, resist * before)
        if springs:
            impulse -= pull * (position + half_step * velocity)
        velocity = velocity + impulse
        position = np.add(ahead, half_step * impulse, out=moved[k])
        twist = angle - position
        before = twist - np.minimum(np.maximum(twist, below), above)
    return moved, position, velocity


def dead_zone_columns(signals: Signals, shapes: Array) -> list[Column]:
    """Load's acceleration less the motor's behind several dead zones, with the spring's share of it.

    Where the speed is the source, the motor's angle is its integral, whose noise no resolution of an encoder adds to.

    Args:
        signals: of one stretch.
        shapes: (k, 4), see `load_positions`.
    """
    angle = signals.position
    if signals.source == "velocity":
        speed = signals.velocity
        steps = 0.5 * signals.sample_period * (speed[1:] + speed[:-1])
        angle = angle[0] + np.concatenate([[0.0], np.cumsum(steps)])
    twist = (load_positions(angle, signals.sample_period, shapes) - angle[:, None]).T
    return [[(load, 2), (rate * load, 0)] for load, rate in zip(twist, shapes[:, 3], strict=True)]
