"""Motion profiles: what an axis is made to do, within the limits of its rig, so that its recording determines what is
wanted.

Their jerk is limited, in closed form: acceleration passes from knot to knot along half a cosine.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from bench.errors import InputError
from bench.names import nearest
from bench.plant.axis_model import AxisParameters
from bench.plant.drive import References, peak_torque
from bench.rig.rig import Rig

#: Without a stated speed, profiles run up to the speed that full torque reaches in this time - s.
RUN_UP = 0.1
#: Share of the motor's stated speed, or no-load speed (supply over back-EMF constant), asked for, against overshoot.
SPEED_SHARE = 0.8
#: Share of peak torque that friction and load may take at top speed; the rest accelerates.
RESISTING_SHARE = 0.5
#: Share of the torque left for acceleration that a motion asks for; the rest is for the controller.
ACCELERATION_SHARE = 0.8
#: Time in which acceleration builds up, as a share of the time to reach top speed: limits the jerk.
RAMP_SHARE = 0.1
#: Travel of a linear axis whose rig states no stroke - m.
TRAVEL = 0.4
#: How much more acceleration than there is `full_torque` asks for, so that the motor gives all it has.
OVERDEMAND = 1.05
#: Ticks in which that demand builds up; time spent at top speed after it - s.
OVERDEMAND_RAMP, AT_TOP = 8.0, 0.2
#: Speed and acceleration of `slow_reversals`, as shares of the limits.
SLOW_SPEED, SLOW_ACCELERATION = 0.04, 0.05
#: Multisine: duration - s, harmonics of its inverse, and the power of frequency that amplitudes of angle fall with.
MULTISINE_DURATION, HARMONICS, FALL = 1.5, (1, 2, 3, 5, 8, 12, 18, 27, 40), 1.5
#: Chirp: duration - s -, first and last frequency - Hz.
CHIRP_DURATION, CHIRP = 5.0, (1.0, 120.0)
#: Share of the multisine, or of the chirp, over which it fades in, and out.
FADE = 0.15
#: Ticks of a motion: 20 minutes of a drive that ticks every 250 us; all signals of one take 0.5 GB.
MOST_TICKS = 5e6


@dataclass(frozen=True)
class MotionLimits:
    """Limits of a motion and the period it is planned at.

    Attributes:
        speed: highest - rad/s (m/s on a linear axis).
        acceleration: highest with some torque in reserve for the controller - rad/s**2 (m/s**2).
        full_acceleration: at peak torque, close to standstill - rad/s**2 (m/s**2).
        travel: from one end to the other - rad (m); infinite on a rotary axis.
        period: of the references - s.
    """

    speed: float
    acceleration: float
    full_acceleration: float
    travel: float
    period: float

    @classmethod
    def from_rig(cls, rig: Rig, parameters: AxisParameters, period: float) -> MotionLimits:
        """Limits from a motor's peak torque and speed, and the inertia and friction, true or identified, it overcomes.

        `period` is that of the references - s. InputError where there is no peak current or torque, or too little
        torque for friction and load.
        """
        torque = peak_torque(rig)
        if not np.isfinite(torque):
            raise InputError(f"{rig.source}: motor.peak_current", "missing", "motions are planned inside its torque")
        standing = parameters.coulomb_friction + abs(parameters.load_torque)
        full = (torque - standing) / parameters.inertia
        if standing >= RESISTING_SHARE * torque:
            found = f"found friction and load of {standing:.3g} {rig.effort_unit}"
            allowed = f"allowed: below half of the peak torque, {RESISTING_SHARE * torque:.3g} {rig.effort_unit}"
            raise InputError(f"{rig.source}: simulation", found, allowed)
        viscous = parameters.viscous_friction_coefficient
        fastest = rig.motor.maximum_speed or rig.motor.rated_speed
        speeds = [] if fastest is None else [fastest]
        if rig.motor.supply_voltage is not None and rig.motor.back_emf_constant is not None:
            speeds.append(rig.motor.supply_voltage / rig.motor.back_emf_constant)
        speed = SPEED_SHARE * min(speeds) if speeds else RUN_UP * full
        if viscous > 0.0:
            speed = min(speed, (RESISTING_SHARE * torque - standing) / viscous)
        acceleration = ACCELERATION_SHARE * (torque - standing - viscous * speed) / parameters.inertia
        travel = math.inf if rig.axis_kind.turns else (rig.load and rig.load.stroke) or TRAVEL
        return cls(speed, acceleration, full, travel, period)

    @property
    def ramp_time(self) -> float:
        """Time in which acceleration builds up - s; at least four ticks."""
        return max(RAMP_SHARE * self.speed / self.acceleration, 4.0 * self.period)


Profile = Callable[[MotionLimits], References]


def fast_reversals(limits: MotionLimits) -> References:
    """The lab's fast run: between top speeds of both directions, never at rest. Determines inertia best."""
    return through_speeds(limits, [limits.speed, -limits.speed] * 4 + [0.0], dwell=0.0)


def full_torque(limits: MotionLimits) -> References:
    """The lab's MaxAcc run: to top speed with all the motor's torque, stay there, and stop gently."""
    up = speed_change(limits.speed, OVERDEMAND * limits.full_acceleration, OVERDEMAND_RAMP * limits.period)
    down = speed_change(-limits.speed, limits.acceleration, limits.ramp_time)
    return s_curve([*up, (AT_TOP, 0.0), *down], limits.period)


def speed_staircase(limits: MotionLimits) -> References:
    """Up and down through steps of speed, each held for a while, both ways. Determines friction over speed best."""
    steps = [share * limits.speed for share in (0.2, 0.4, 0.6, 0.8, 1.0, 0.7, 0.3, 0.1)]
    return through_speeds(limits, [*steps, *(-step for step in steps), 0.0], dwell=0.06)


def slow_reversals(limits: MotionLimits) -> References:
    """To and fro at a few percent of top speed: breakaway, and friction close to standstill."""
    slow = replace(limits, speed=SLOW_SPEED * limits.speed, acceleration=SLOW_ACCELERATION * limits.acceleration)
    return through_speeds(slow, [slow.speed, -slow.speed, slow.speed, -slow.speed, 0.0], dwell=0.1)


def multisine(limits: MotionLimits) -> References:
    """A sum of sines, faded in and out: many frequencies at once, low peaks.

    Phases by M. R. Schroeder, IEEE Trans. Inf. Theory 16 (1970) 85-89.
    """
    time = limits.period * np.arange(round(MULTISINE_DURATION / limits.period) + 1, dtype=np.float64)
    order = np.asarray(HARMONICS)[:, None]
    frequency = 2.0 * np.pi * order / MULTISINE_DURATION
    phase = frequency * time - np.pi * (np.arange(len(HARMONICS)) ** 2 / len(HARMONICS))[:, None]
    amplitude = order**-FALL
    x = (amplitude * np.sin(phase)).sum(axis=0)
    v = (amplitude * frequency * np.cos(phase)).sum(axis=0)
    a = (-amplitude * frequency**2 * np.sin(phase)).sum(axis=0)
    return _faded(limits, time, x, v, a)


def chirp(limits: MotionLimits) -> References:
    """A sine whose frequency rises, faded in and out: the frequency response of a flexible axis.

    x = g*sin(p), g = f**-FALL, f = f1*(f2/f1)**(t/T), dp/dt = 2*pi*f.
    """
    time = limits.period * np.arange(round(CHIRP_DURATION / limits.period) + 1, dtype=np.float64)
    rate = math.log(CHIRP[1] / CHIRP[0]) / CHIRP_DURATION
    omega = 2.0 * np.pi * CHIRP[0] * np.exp(rate * time)
    g, falls = omega**-FALL, -FALL * rate
    sine, cosine = np.sin((omega - omega[0]) / rate), np.cos((omega - omega[0]) / rate)
    v = g * (falls * sine + omega * cosine)
    a = g * ((falls**2 - omega**2) * sine + (2.0 * falls + rate) * omega * cosine)
    return _faded(limits, time, g * sine, v, a)


def identification(limits: MotionLimits) -> References:
    """Fast reversals, staircase, slow reversals and multisine in turn: everything that J, K_w and K_0 need."""
    parts = (fast_reversals, speed_staircase, slow_reversals, multisine)
    return reduce(References.then, (part(limits) for part in parts))


PROFILES: dict[str, Profile] = {
    profile.__name__: profile
    for profile in (identification, fast_reversals, full_torque, speed_staircase, slow_reversals, multisine, chirp)
}


def plan(name: str, limits: MotionLimits) -> References:
    """The motion of a named profile, slowed down until it fits into the travel; InputError where there is none."""
    if name not in PROFILES:
        found = f"found '{name}'{nearest(name, list(PROFILES))}"
        raise InputError("profile", found, f"allowed: {', '.join(PROFILES)}")
    references = PROFILES[name](limits)
    while np.ptp(references.position) > limits.travel:
        limits = replace(limits, speed=0.9 * limits.speed)
        references = PROFILES[name](limits)
    return references


def _faded(limits: MotionLimits, time: np.ndarray, x: np.ndarray, v: np.ndarray, a: np.ndarray) -> References:
    """A motion faded in and out, as large as the limits allow."""
    w, dw, ddw = _fade(time / time[-1], 1.0 / time[-1])
    x, v, a = w * x, dw * x + w * v, ddw * x + 2.0 * dw * v + w * a
    scale = min(limits.speed / np.abs(v).max(), limits.acceleration / np.abs(a).max())
    return References(time, scale * x, scale * v, scale * a)


def _fade(share: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Window from 0 to 1 and back over a share of the time, s = 10u**3-15u**4+6u**5, and two derivatives by time."""
    rising = share < 0.5
    u = np.clip(np.where(rising, share, 1.0 - share) / FADE, 0.0, 1.0)
    du = np.where(rising, 1.0, -1.0) * rate / FADE
    w = u**3 * (10.0 + u * (6.0 * u - 15.0))
    slope = 30.0 * u**2 * (1.0 - u) ** 2
    bend = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)
    return w, slope * du, bend * du**2


def s_curve(pieces: Sequence[tuple[float, float]], period: float) -> References:
    """Motion from rest whose acceleration passes from one knot to the next along half a cosine.

    Within a piece of duration T from acceleration a0 to a1, with p = pi*t/T and d = (a1 - a0)/2:
        a = a0 + d*(1 - cos(p)),  v = v0 + a0*t + d*(t - T/pi*sin(p)),
        x = x0 + v0*t + a0*t**2/2 + d*(t**2/2 + (T/pi)**2*(cos(p) - 1)).

    Args:
        pieces: duration - s -, of zero to be passed over, and acceleration at the end - rad/s**2 (m/s**2) - of each.
        period: of the ticks, which go from zero to the first at or after the end - s.

    Raises:
        InputError: it takes more than `MOST_TICKS`.
    """
    length, end = np.array([piece for piece in pieces if piece[0] > 0.0], dtype=np.float64).reshape(-1, 2).T
    length = np.append(length, period)  # at rest, for the tick after the end
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


def through_speeds(limits: MotionLimits, speeds: Sequence[float], dwell: float) -> References:
    """Motion from rest within limits through speeds - rad/s (m/s) -, each held for `dwell` - s."""
    pieces = []
    for change in np.diff([0.0, *speeds]):
        pieces += [*speed_change(float(change), limits.acceleration, limits.ramp_time), (dwell, 0.0)]
    return s_curve(pieces, limits.period)


def speed_change(change: float, acceleration: float, ramp_time: float) -> list[tuple[float, float]]:
    """Pieces as `s_curve` takes them in which speed changes: build up, hold, fade.

    A change too small to reach the acceleration within the ramp stays below it.
    """
    top = math.copysign(min(acceleration, abs(change) / ramp_time), change)
    hold = change / top - ramp_time if top else 0.0
    return [(ramp_time, top), (hold, top), (ramp_time, 0.0)]
