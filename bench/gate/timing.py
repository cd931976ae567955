"""Is time regular, and is it sampled at a rate that this motion can have?"""

from __future__ import annotations

import math

import numpy as np

from bench.arrays import Array, rms
from bench.axis_kind import INERTIA
from bench.gate.balance import balance, effort_of
from bench.gate.check import Check, absent
from bench.gate.parts import speed_of, stretches
from bench.rig.rig import Rig
from bench.trace.time_base import HOLE, TimeBase
from bench.trace.trace import Trace

REGULAR, RATE = "time_is_regular", "sampling_rate_plausible"
#: Deviation of a step from whole sample periods that is told, and that is refused where nothing resampled it - share.
JITTER, IRREGULAR = 0.05, 0.1
#: Share of a regular base that may be placed between measured samples.
PLACED = 0.5
#: Rates that no recording of a servo's motion has: a unit of time is wrong - Hz.
LOWEST, HIGHEST = 2.0, 200e3
#: Below this rate - Hz - an axis that turns more than this between samples - rad - moves faster than it is recorded.
SLOW, TURNED = 20.0, math.pi
#: Speed and effort that change by more than this share of their spread from one sample to the next, and whose changes
#: are no more alike than this from one to the next, however many samples are averaged, were not followed. Noise may do
#: that to one of them, undersampling does it to both.
CHANGES, ALIKE = 0.3, 0.85
#: Spread of speed, as share of its RMS, below which it is steady and its noise is all that changes.
STEADY = 0.1
#: Times the motor's own inertia (mass) that no load has: milliseconds read as seconds make any axis heavier than that.
HEAVY = 1000.0
#: Samples of the windows over which that inertia is read.
WINDOW = 16
LEAST = 64

ALLOWED_TIME = "steps of one sample period, but for holes"
ALLOWED_RATE = f"{LOWEST:g} Hz to {HIGHEST / 1e3:g} kHz, and several samples while the speed changes"


def regular(trace: Trace, rig: Rig | None) -> tuple[Trace, Check]:
    """Whether the sample times are regular; the recording stays as it is."""
    base = trace.time_base or _base_of(trace)
    holes = f"{len(base.holes)} holes" if base.holes else "no hole"
    found = f"steps of {base.sample_period:.4g} s within {base.jitter:.1%}, {holes}"
    advice = "record with the drive's own clock"
    if base.interpolated > PLACED * len(trace):
        return trace, Check(REGULAR, "fail", f"{found}; {base.interpolated} samples missing", ALLOWED_TIME, advice)
    if not base.resampled and base.jitter > IRREGULAR:
        allowed = f"{ALLOWED_TIME} (Trace.from_arrays and read bring others to them)"
        return trace, Check(REGULAR, "fail", found, allowed, advice)
    if base.resampled and base.jitter > JITTER:
        return trace, Check(REGULAR, "warn", f"{found}; interpolated onto regular times", ALLOWED_TIME, advice)
    return trace, Check(REGULAR, "pass", found, ALLOWED_TIME)


def _base_of(trace: Trace) -> TimeBase:
    """What a reader would have found about times that none brought to a regular base."""
    step = np.diff(trace.time)
    near = step[step <= HOLE * trace.sample_period]
    jitter = float(np.abs(near / trace.sample_period - 1.0).max()) if near.size else 0.0
    at = np.flatnonzero(step > HOLE * trace.sample_period)
    return TimeBase(trace.sample_period, jitter, tuple((float(trace.time[k]), float(step[k])) for k in at))


def rate(trace: Trace, rig: Rig | None) -> tuple[Trace, Check]:
    """Whether the rate can be right, and follows the motion; the recording stays as it is."""
    hertz = 1.0 / trace.sample_period
    told = f"{hertz:.5g} Hz"
    unit = "check the unit of the time column, or the sample period"
    if not LOWEST <= hertz <= HIGHEST:
        return trace, Check(RATE, "fail", f"{told}, {_duration(trace)} in all", ALLOWED_RATE, unit)
    parts = [] if "velocity" not in trace and "position" not in trace else list(stretches(trace, LEAST))
    speeds = [speed for part in parts if (speed := speed_of(trace, part)) is not None]
    if not speeds:
        return trace, absent(RATE, f"{told}; no stretch of {LEAST} samples of motion", ALLOWED_RATE)
    turned = float(np.percentile(np.abs(np.concatenate(speeds)), 95.0)) * trace.sample_period
    if hertz < SLOW and trace.axis_kind.turns and turned > TURNED:
        found = f"{told}, at which the axis turns {turned:.3g} rad from one sample to the next"
        return trace, Check(RATE, "fail", found, ALLOWED_RATE, f"{unit}, or record faster", unanswerable=True)
    changes = _missed(trace, rig, parts, speeds)
    if changes is not None:
        found = f"{told}, at which speed changes by {changes:.0%} of its spread from one sample to the next"
        return trace, Check(RATE, "fail", found, ALLOWED_RATE, f"record faster, or {unit}", unanswerable=True)
    heavy = _heavy(trace, rig)
    if heavy is not None:
        found = f"{told}, which makes {trace.axis_kind.in_words(INERTIA)} {heavy:.3g} times the motor's own"
        return trace, Check(RATE, "fail", found, f"below {HEAVY:g} times", f"{unit}, of current and of speed")
    return trace, Check(RATE, "pass", told, ALLOWED_RATE)


def _duration(trace: Trace) -> str:
    return f"{trace.time[-1] - trace.time[0]:.4g} s"


def _missed(trace: Trace, rig: Rig | None, parts: list[slice], speeds: list[Array]) -> float | None:
    """Change of speed from sample to sample over its spread, where motion passed between the samples."""
    every = np.concatenate(speeds)
    if float(np.std(every)) <= STEADY * rms(every):
        return None
    effort = effort_of(trace, rig)
    changes, alike = followed(speeds)
    if changes <= CHANGES or alike >= ALIKE:
        return None
    if effort is not None:
        rough, like = followed([effort[0][part] for part in parts])
        if rough <= CHANGES or like >= ALIKE:
            return None
    return changes


def followed(signals: list[Array]) -> tuple[float, float]:
    """RMS change from sample to sample over the spread, and the best correlation of successive changes."""
    spread = float(np.std(np.concatenate(signals)))
    changes = rms(np.concatenate([np.diff(values) for values in signals]))
    alike, size = -1.0, 1
    while (means := [_averaged(values, size) for values in signals if values.size >= 8 * size]) and size <= LEAST:
        steps = [np.diff(mean) for mean in means]
        power = sum(float(step @ step) for step in steps)
        alike = max(alike, sum(float(step[1:] @ step[:-1]) for step in steps) / power) if power > 0.0 else alike
        size *= 2
    return (changes / spread if spread > 0.0 else 0.0), alike


def _averaged(values: Array, size: int) -> Array:
    count = values.size // size
    return values[: count * size].reshape(count, size).mean(axis=1)


def _heavy(trace: Trace, rig: Rig | None) -> float | None:
    """Times the motor's own inertia (mass), where the recording makes it more than any load can be."""
    rotor = (rig.motor.rotor_inertia or rig.motor.moving_mass) if rig is not None else None
    if rig is None or rotor is None or effort_of(trace, rig) is None or rig.effort(trace)[1] != rig.effort_unit:
        return None
    fitted = balance(trace, rig.effort(trace)[0], (WINDOW,))
    if fitted is None or fitted.by_motion < 0.5:
        return None
    ratio = float(fitted.theta[0]) / rotor
    return ratio if ratio > HEAVY else None
