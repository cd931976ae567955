"""Is time regular, and is it sampled at a rate that this motion can have?"""

from __future__ import annotations

import math

import numpy as np

from bench.arrays import Array, rms
from bench.axis_kind import INERTIA
from bench.gate.check import JITTER, Check, Seen, absent
from bench.names import counted, percent
from bench.trace.time_base import HOLE, TimeBase
from bench.trace.trace import Trace

REGULAR, RATE = "time_is_regular", "sampling_rate_plausible"
#: Deviation of a step from whole sample periods that is refused where nothing resampled it - share.
IRREGULAR = 0.1
#: Times the shortest of four of five steps that the longest may have: what two of three lost samples leave.
UNEVEN = 3.0
#: Share of a regular base that may be placed between measured samples.
PLACED = 0.5
#: Rates that no recording of a servo's motion has: a unit of time is wrong - Hz.
LOWEST, HIGHEST = 2.0, 200e3
#: Below this rate - Hz - an axis that turns more than this between samples - rad - moves faster than it is recorded.
SLOW, TURNED = 20.0, math.pi
#: Change over the spread from one sample to the next, and correlation of changes, of a signal that was not followed.
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


def regular(seen: Seen) -> Check:
    """Whether the sample times are regular."""
    trace = seen.trace
    base = trace.time_base or _base_of(trace)
    holes = counted(len(base.holes), "hole") if base.holes else "no hole"
    found = f"steps of {base.sample_period:.4g} s, jitter {percent(base.jitter)}, {holes}"
    advice = "record with the drive's own clock"
    if base.steps is not None and base.steps[1] > UNEVEN * base.steps[0]:
        found = f"steps of {base.steps[0]:.3g} to {base.steps[1]:.3g} s, four of five: no sample period"
        return Check(REGULAR, "fail", found, ALLOWED_TIME, f"{advice}, or at a rate that the recorder keeps up with")
    if base.interpolated > PLACED * len(trace):
        return Check(REGULAR, "fail", f"{found}; {counted(base.interpolated, 'sample')} missing", ALLOWED_TIME, advice)
    if not base.resampled and base.jitter > IRREGULAR:
        allowed = f"{ALLOWED_TIME} (Trace.from_arrays and read bring others to them)"
        return Check(REGULAR, "fail", found, allowed, advice)
    if base.resampled and base.jitter > JITTER:
        return Check(REGULAR, "warn", f"{found}; interpolated onto regular times", ALLOWED_TIME, advice)
    return Check(REGULAR, "pass", found, ALLOWED_TIME)


def _base_of(trace: Trace) -> TimeBase:
    """What a reader would have found about times that none brought to a regular base."""
    step = np.diff(trace.time)
    near = step[step <= HOLE * trace.sample_period]
    jitter = float(np.abs(near / trace.sample_period - 1.0).max()) if near.size else 0.0
    at = np.flatnonzero(step > HOLE * trace.sample_period)
    return TimeBase(trace.sample_period, jitter, tuple((float(trace.time[k]), float(step[k])) for k in at))


def rate(seen: Seen) -> Check:
    """Whether the rate can be right, and follows the motion."""
    trace = seen.trace
    hertz = 1.0 / trace.sample_period
    found = f"{hertz:.5g} Hz"
    unit = "check the unit of the time column, or the sample period"
    if not LOWEST <= hertz <= HIGHEST:
        return Check(RATE, "fail", f"{found}, {trace.time[-1] - trace.time[0]:.4g} s in all", ALLOWED_RATE, unit)
    parts = seen.stretches(LEAST) if seen.tells_motion else []
    speeds = [seen.speed(part) for part in parts]
    if not speeds:
        return absent(RATE, f"{found}; no stretch of {LEAST} samples of motion", ALLOWED_RATE)
    turned = float(np.percentile(np.abs(np.concatenate(speeds)), 95.0)) * trace.sample_period
    if hertz < SLOW and trace.axis_kind.turns and turned > TURNED:
        found = f"{found}, at which the axis turns {turned:.3g} rad from one sample to the next"
        return Check(RATE, "fail", found, ALLOWED_RATE, f"{unit}, or record faster", unanswerable=True)
    every = np.concatenate(speeds)
    changes = 0.0 if float(np.std(every)) <= STEADY * rms(every) else _missed(speeds)
    if changes:
        effort = [seen.effort[0][part] for part in parts] if seen.effort is not None else speeds
        position = [trace["position"][part] for part in parts] if "position" in trace else None
        if _missed(effort) and (position is None or followed(position)[1] < ALIKE):
            found = f"{found}, at which speed changes by {percent(changes)} of its spread from one sample to the next"
            noise = "record the position too, which separates noise from fast motion, or " * (position is None)
            advice = f"{noise}record faster; if the drive oscillates, lower its gains"
            return Check(RATE, "fail", found, ALLOWED_RATE, advice, unanswerable=True)
        found = f"{found}; the speed contains noise: it changes by {percent(changes)} of its spread in one sample"
    heavy = _heavy(seen)
    if heavy is not None:
        found = f"{found}, which makes {trace.axis_kind.in_words(INERTIA)} {heavy:.3g} times the motor's own"
        return Check(RATE, "fail", found, f"below {HEAVY:g} times", f"{unit}, of current and of speed")
    return Check(RATE, "pass", found, ALLOWED_RATE)


def _missed(signals: list[Array]) -> float:
    """Change from sample to sample, over the spread, of a signal that was not followed; 0 of one that was."""
    changes, alike = followed(signals)
    return changes if changes > CHANGES and alike < ALIKE else 0.0


def followed(signals: list[Array]) -> tuple[float, float]:
    """RMS change from sample to sample over the spread, and the best correlation of successive changes."""
    spread = float(np.std(np.concatenate(signals)))
    changes = rms(np.concatenate([np.diff(values) for values in signals]))
    alike, size, means = -1.0, 1, signals
    while (means := [mean for mean in means if mean.size >= 8]) and size <= LEAST:
        steps = [np.diff(mean) for mean in means]
        power = sum(float(step @ step) for step in steps)
        alike = max(alike, sum(float(step[1:] @ step[:-1]) for step in steps) / power) if power > 0.0 else alike
        means = [0.5 * (mean[:-1:2] + mean[1::2]) for mean in means]  # over twice as many samples
        size *= 2
    return (changes / spread if spread > 0.0 else 0.0), alike


def _heavy(seen: Seen) -> float | None:
    """Times the motor's own inertia (mass), where the recording makes it more than any load can be."""
    rig = seen.rig
    if rig is None or not rig.motor.inertia or seen.effort is None or rig.effort(seen.trace)[1] != rig.effort_unit:
        return None
    fitted = seen.balance((WINDOW,))
    ratio = fitted.inertia / rig.motor.inertia if fitted is not None and fitted.by_motion >= 0.5 else 0.0
    return ratio if ratio > HEAVY else None
