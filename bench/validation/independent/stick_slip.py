"""Exact motion of a body under a constant torque with viscous and dry friction, stopping and breaking away included."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def speed_weight(rate: Array, time: Array) -> Array:
    """phi(t) = (1 - exp(-k*t))/k - s; t for k = 0. rate k = K_w/J - 1/s."""
    x = rate * time
    series = time * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0))))
    return np.where(x < 1e-3, series, -np.expm1(-x) / np.where(rate > 0.0, rate, 1.0))


def distance_weight(rate: Array, time: Array) -> Array:
    """psi(t) = (t - phi(t))/k, the integral of phi - s**2; t**2/2 for k = 0."""
    x = rate * time
    series = time**2 / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0))))
    return np.where(x < 1e-3, series, (time - speed_weight(rate, time)) / np.where(rate > 0.0, rate, 1.0))


def stopping_time(rate: Array, speed: Array, acceleration: Array) -> Array:
    """When w(t) = w0 + a0*phi(t) reaches zero, phi(t) = -w0/a0: t = -log(1 - k*phi)/k - s."""
    weight = -speed / acceleration
    x = rate * weight
    series = weight * (1.0 + x / 2.0 + x**2 / 3.0 + x**3 / 4.0 + x**4 / 5.0)
    return np.where(np.abs(x) < 1e-3, series, -np.log1p(-x) / np.where(rate > 0.0, rate, 1.0))


def breakaway(torque: Array, forward_level: Array, backward_level: Array) -> Array:
    """Direction in which a resting body starts: +1, -1, or 0 while |torque| stays within the friction level."""
    return np.where(torque > forward_level, 1.0, np.where(torque < -backward_level, -1.0, 0.0))


def move(
    speed: Array,
    torque: Array,
    forward_level: Array,
    backward_level: Array,
    inertia: Array,
    rate: Array,
    weights: tuple[Array, Array],
    step: float,
) -> tuple[Array, Array]:
    """Speed after `step`, and distance gone, of J*dw/dt = torque - K_w*w - level*sgn(w); all arguments constant in it.

    A body that comes to rest within the step stays there if the torque is within the level of the direction it pulls
    to, and starts again from the instant of rest otherwise.

    Args:
        speed, torque, inertia, rate: w - rad/s, M - N*m, J - kg*m**2, K_w/J - 1/s - (n,) each.
        forward_level, backward_level: dry friction against positive and negative motion - N*m - (n,).
        weights: phi and psi of the whole step - s, s**2 - (n,).
    """
    direction = np.sign(speed)
    if not direction.all():
        direction = np.where(direction == 0.0, breakaway(torque, forward_level, backward_level), direction)
    friction = np.where(direction > 0.0, forward_level, backward_level) * direction
    acceleration = (torque - friction) / inertia - rate * speed
    if not direction.all():
        acceleration = np.where(direction == 0.0, 0.0, acceleration)
    after = speed + acceleration * weights[0]
    distance = speed * step + acceleration * weights[1]
    stops = np.flatnonzero(after * direction < 0.0)
    if stops.size:
        w, a, k, moment = speed[stops], acceleration[stops], rate[stops], torque[stops]
        time = stopping_time(k, w, a)
        way = w * time + a * distance_weight(k, time)
        onward = breakaway(moment, forward_level[stops], backward_level[stops])
        level = np.where(onward > 0.0, forward_level[stops], backward_level[stops])
        start = np.where(onward == 0.0, 0.0, (moment - onward * level) / inertia[stops])
        after[stops] = start * speed_weight(k, step - time)
        distance[stops] = way + start * distance_weight(k, step - time)
    return after, distance
