"""Motions of limited jerk, in closed form: acceleration passes from knot to knot along half a cosine."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bench.errors import InputError
from bench.plant.references import References

#: Ticks of a motion: 20 minutes of a drive that ticks every 250 us; all signals of one take 0.5 GB.
MOST_TICKS = 5e6


def s_curve(durations: Sequence[float], accelerations: Sequence[float], period: float) -> References:
    """Motion from rest whose acceleration passes from one knot to the next along half a cosine.

    Within a piece of duration T from acceleration a0 to a1, with p = pi*t/T and d = (a1 - a0)/2:
        a = a0 + d*(1 - cos(p)),  v = v0 + a0*t + d*(t - T/pi*sin(p)),
        x = x0 + v0*t + a0*t**2/2 + d*(t**2/2 + (T/pi)**2*(cos(p) - 1)).

    Args:
        durations: of the pieces, those of zero length are passed over - s - (m,).
        accelerations: at the end of each piece, the first one starting at zero - rad/s**2 (m/s**2) - (m,).
        period: of the ticks - s.

    Returns:
        References at ticks from zero to the first at or after the end.

    Raises:
        InputError: it takes more than `MOST_TICKS`.
    """
    length = np.asarray(durations, dtype=np.float64)
    end = np.asarray(accelerations, dtype=np.float64)[length > 0.0]
    length = np.append(length[length > 0.0], period)  # at rest, for the tick after the end
    start, end = np.append(0.0, end), np.append(end, end[-1])
    rise = (end - start) / 2.0
    gained = start * length + rise * length
    velocity = np.append(0.0, np.cumsum(gained)[:-1])
    moved = velocity * length + start * length**2 / 2.0 + rise * (length**2 / 2.0 - 2.0 * (length / np.pi) ** 2)
    position = np.append(0.0, np.cumsum(moved)[:-1])
    knots = np.append(0.0, np.cumsum(length)[:-1])

    ticks = knots[-1] / period
    if not ticks < MOST_TICKS:
        raise InputError("the motion", f"takes {ticks:.3g} periods of the drive", f"allowed: below {MOST_TICKS:g}")
    time = period * np.arange(int(np.ceil(ticks - 1e-9)) + 1, dtype=np.float64)
    piece = np.searchsorted(knots, time, side="right") - 1
    t, a0, d, scale = time - knots[piece], start[piece], rise[piece], length[piece] / np.pi
    phase = t / scale
    return References(
        time,
        position[piece] + velocity[piece] * t + a0 * t**2 / 2.0 + d * (t**2 / 2.0 + scale**2 * (np.cos(phase) - 1.0)),
        velocity[piece] + a0 * t + d * (t - scale * np.sin(phase)),
        a0 + d * (1.0 - np.cos(phase)),
    )


def through_speeds(
    speeds: Sequence[float], dwell: float, acceleration: float, ramp_time: float, period: float
) -> References:
    """Motion from rest through a sequence of speeds, each held for a while.

    Args:
        speeds: to pass through in order - rad/s (m/s).
        dwell: time at each - s.
        acceleration: highest on the way - rad/s**2 (m/s**2).
        ramp_time: in which it builds up, and fades - s.
        period: of the ticks - s.
    """
    durations: list[float] = []
    accelerations: list[float] = []
    for change in np.diff([0.0, *speeds]):
        lengths, knots = speed_change(float(change), acceleration, ramp_time)
        durations += [*lengths, dwell]
        accelerations += [*knots, 0.0]
    return s_curve(durations, accelerations, period)


def speed_change(change: float, acceleration: float, ramp_time: float) -> tuple[list[float], list[float]]:
    """Durations - s - and end accelerations of the pieces in which speed changes: build up, hold, fade.

    A change too small to reach the acceleration within the ramp stays below it.
    """
    top = math.copysign(min(acceleration, abs(change) / ramp_time), change)
    hold = change / top - ramp_time if top else 0.0
    return [ramp_time, hold, ramp_time], [top, top, 0.0]
