"""Motion profiles: what an axis is made to do so that its recording tells what is asked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import reduce

import numpy as np

from bench.errors import InputError
from bench.names import nearest
from bench.plant.limits import MotionLimits
from bench.plant.references import References
from bench.plant.s_curve import s_curve, speed_change, through_speeds

Profile = Callable[[MotionLimits], References]

#: How much more acceleration than there is `full_torque` asks for, so that the motor gives all it has.
OVERDEMAND = 1.05
#: Ticks in which that demand builds up; time spent at top speed after it - s.
OVERDEMAND_RAMP, AT_TOP = 8.0, 0.2
#: Speed and acceleration of `slow_reversals`, as shares of the limits.
SLOW_SPEED, SLOW_ACCELERATION = 0.04, 0.05
#: Multisine: duration - s, harmonics of its inverse, and the power of frequency that amplitudes of angle fall with.
MULTISINE_DURATION, HARMONICS, FALL = 1.5, (1, 2, 3, 5, 8, 12, 18, 27, 40), 1.5
#: Share of the multisine over which it fades in, and out.
FADE = 0.15


def fast_reversals(limits: MotionLimits) -> References:
    """The lab's fast run: accelerate and decelerate between the two directions, never at rest. Tells inertia best."""
    return _through(limits, [limits.speed, -limits.speed] * 4 + [0.0], dwell=0.0)


def full_torque(limits: MotionLimits) -> References:
    """The lab's MaxAcc run: to top speed with all the motor's torque, stay there, and stop gently."""
    up = speed_change(limits.speed, OVERDEMAND * limits.full_acceleration, OVERDEMAND_RAMP * limits.period)
    down = speed_change(-limits.speed, limits.acceleration, limits.ramp_time)
    return s_curve([*up[0], AT_TOP, *down[0]], [*up[1], 0.0, *down[1]], limits.period)


def speed_staircase(limits: MotionLimits) -> References:
    """Up and down through steps of speed, each held for a while, in both directions. Tells friction over speed best."""
    steps = [share * limits.speed for share in (0.2, 0.4, 0.6, 0.8, 1.0, 0.7, 0.3, 0.1)]
    return _through(limits, [*steps, *(-step for step in steps), 0.0], dwell=0.06)


def slow_reversals(limits: MotionLimits) -> References:
    """To and fro at a few percent of top speed: breakaway, and friction close to standstill."""
    slow = replace(limits, speed=SLOW_SPEED * limits.speed, acceleration=SLOW_ACCELERATION * limits.acceleration)
    return _through(slow, [slow.speed, -slow.speed, slow.speed, -slow.speed, 0.0], dwell=0.1)


def multisine(limits: MotionLimits) -> References:
    """A sum of sines with Schroeder's phases, faded in and out: many frequencies at once, low peaks.

    Source: M. R. Schroeder, IEEE Trans. Inf. Theory 16 (1970) 85-89.
    """
    time = limits.period * np.arange(round(MULTISINE_DURATION / limits.period) + 1, dtype=np.float64)
    order = np.asarray(HARMONICS)[:, None]
    frequency = 2.0 * np.pi * order / MULTISINE_DURATION
    phase = frequency * time - np.pi * (np.arange(len(HARMONICS)) ** 2 / len(HARMONICS))[:, None]
    amplitude = order**-FALL
    x = (amplitude * np.sin(phase)).sum(axis=0)
    v = (amplitude * frequency * np.cos(phase)).sum(axis=0)
    a = (-amplitude * frequency**2 * np.sin(phase)).sum(axis=0)
    w, dw, ddw = _fade(time / time[-1], 1.0 / time[-1])
    x, v, a = w * x, dw * x + w * v, ddw * x + 2.0 * dw * v + w * a
    scale = min(limits.speed / np.abs(v).max(), limits.acceleration / np.abs(a).max())
    return References(time, scale * x, scale * v, scale * a)


def identification(limits: MotionLimits) -> References:
    """Fast reversals, staircase, slow reversals and multisine in turn: everything that J, K_w and K_0 need."""
    parts = (fast_reversals, speed_staircase, slow_reversals, multisine)
    return reduce(References.then, (part(limits) for part in parts))


PROFILES: dict[str, Profile] = {
    profile.__name__: profile
    for profile in (identification, fast_reversals, full_torque, speed_staircase, slow_reversals, multisine)
}


def plan(name: str, limits: MotionLimits) -> References:
    """The motion of a named profile, slowed down until it fits into the travel.

    Raises:
        InputError: no profile of this name.
    """
    if name not in PROFILES:
        raise InputError(
            "--profile", f"found '{name}'{nearest(name, list(PROFILES))}", f"allowed: {', '.join(PROFILES)}"
        )
    references = PROFILES[name](limits)
    while np.ptp(references.position) > limits.travel:
        limits = replace(limits, speed=0.9 * limits.speed)
        references = PROFILES[name](limits)
    return references


def _through(limits: MotionLimits, speeds: list[float], dwell: float) -> References:
    return through_speeds(speeds, dwell, limits.acceleration, limits.ramp_time, limits.period)


def _fade(share: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Window from 0 to 1 and back with two continuous derivatives, at a share of the time; s = 10u**3-15u**4+6u**5.

    Returns the window and its derivatives by time, `rate` being the derivative of the share - 1/s.
    """
    rising = share < 0.5
    u = np.clip(np.where(rising, share, 1.0 - share) / FADE, 0.0, 1.0)
    du = np.where(rising, 1.0, -1.0) * rate / FADE
    w = u**3 * (10.0 + u * (6.0 * u - 15.0))
    slope = 30.0 * u**2 * (1.0 - u) ** 2
    bend = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)
    return w, slope * du, bend * du**2
