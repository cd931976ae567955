"""The corner of a run-up: the speed at which torque starts to decline, as full voltage no longer drives peak current.

    L*dIq/dt + R*Iq = U - Ke*omega  beyond it,  so  Iq = top*(omega_0 - omega)/(omega_0 - omega_c), late by tau = L/R

At the corner itself Iq is constant, dIq/dt = 0: U = R*top + Ke*omega_c holds with inductance and without. So inductance
moves what follows, the fall, and not the corner: it keeps the current up for about tau, in which speed rises by
alpha*tau.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.signal import lfilter

from bench.arrays import Array
from bench.errors import UndeterminedError

#: Stretch of the falling current, in shares of its top, that the line is fitted to.
FROM, TO = 0.9, 0.5
#: Faster samples, as a share of the highest speed, may belong to the drive's own stop at the speed asked for.
STILL_RISING = 0.97
#: The top is the median of samples above this share of the largest.
TOP = 0.95
#: Time constant that the search for it starts from - s.
TYPICAL = 2e-3
#: Points of the model a sample: the current bends between two of them.
FINER = 8


@dataclass(frozen=True)
class Decline:
    """How the current falls beyond the corner.

    Attributes:
        corner: speed at which it starts to - rad/s.
        no_load: speed at which it would end, as the winding was during the run - rad/s.
        lag: tau, by which it comes late, L/R - s.
        extrapolated: speed at which the line through the fall from 90 to 50 % meets the top - rad/s; the corner without
            inductance, later by alpha*tau with it.
    """

    corner: float
    no_load: float
    lag: float
    extrapolated: float


def extrapolated_corner(velocity: Array, current: Array) -> float:
    """Speed at which the line through the falling current meets the current's top - rad/s.

    In the circuit U = R*Iq + Ke*omega at full voltage, current falls linearly with speed, so the line is the physics
    and the corner that of the datasheet's curve. (Torque does not: kT rises as the current falls.)

    Args:
        velocity, current: (n,) of one run-up - rad/s, A.

    Raises:
        UndeterminedError: the current does not fall to half while the axis accelerates.
    """
    slope, offset = _line(velocity, current)
    return float((_top(current)[0] - offset) / slope)


def decline(velocity: Array, current: Array, sample_period: float) -> Decline:
    """Corner, end and lag of the fall, by least squares on the current from its top to half of it.

    Args:
        velocity, current: (n,) of one run-up, evenly sampled - rad/s, A.
        sample_period: s.

    Raises:
        UndeterminedError: the current does not fall to half while the axis accelerates.
    """
    slope, offset = _line(velocity, current)
    top, high = _top(current)
    below = np.flatnonzero((np.arange(current.size) > high[-1]) & (current < TO * top))
    stopped = np.flatnonzero(velocity >= STILL_RISING * velocity.max())
    ends = [int(found[0]) for found in (below, stopped) if found.size]
    part = slice(int(high[0]), min(ends, default=current.size))
    speed, measured = velocity[part], current[part]
    start = float((top - offset) / slope), float(-offset / slope)
    between = np.interp(np.arange((speed.size - 1) * FINER + 1) / FINER, np.arange(speed.size), speed)

    def modelled(theta: Array) -> Array:
        corner, no_load, lag = theta
        quasi_static = np.minimum(top, top * (no_load - between) / (no_load - corner))
        return _late(quasi_static, lag, sample_period / FINER)[::FINER]

    scale = np.array([start[0], start[1], TYPICAL])
    found = least_squares(
        lambda theta: modelled(theta) - measured,
        [start[0], start[1], TYPICAL],
        bounds=([0.0, 0.5 * (start[0] + start[1]), 0.0], [0.5 * (start[0] + start[1]), 10.0 * start[1], 1.0]),
        x_scale=scale,
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-12,
    )
    corner, no_load, lag = (float(value) for value in found.x)
    return Decline(corner, no_load, lag, start[0])


def _late(values: Array, lag: float, period: float) -> Array:
    """Response of a first-order lag to a signal that is straight between samples, at rest before it."""
    if lag < 1e-6 * period:
        return values
    a = np.exp(-period / lag)
    b = lag / period * (1.0 - a)
    # x[k] = a*x[k-1] + (1 - b)*u[k] + (b - a)*u[k-1]: exact for u straight between its samples
    return np.asarray(lfilter([1.0 - b, b - a], [1.0, -a], values, zi=[b * values[0]])[0], dtype=np.float64)


def _top(current: Array) -> tuple[float, NDArray[np.int64]]:
    """Median of the current at its top, and the samples there."""
    high = np.flatnonzero(current > TOP * float(current.max()))
    return float(np.median(current[high[0] : high[-1] + 1])), high


def _line(velocity: Array, current: Array) -> tuple[float, float]:
    """Slope - A*s/rad - and offset - A - of the fall from 90 to 50 % over speed."""
    largest = float(current.max())
    high = np.flatnonzero(current > TOP * largest)
    falling = np.arange(current.size) > high[-1]
    falling &= (current < FROM * largest) & (current > TO * largest) & (velocity < STILL_RISING * velocity.max())
    speeds = velocity[falling]
    if speeds.size < 3 or np.ptp(speeds) <= 0.0:
        reason = "the current does not fall from its top to half of it as speed rises"
        raise UndeterminedError("corner speed", reason, "a run-up with full torque to close to the no-load speed")
    slope, offset = np.polyfit(speeds, current[falling], 1)
    return float(slope), float(offset)
