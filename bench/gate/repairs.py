"""What the gate puts right: samples that were lost, and positions that wrap.

Samples that a recorder lost, or wrote twice, and numbered on as if nothing had happened.

Each loss is a jump in position that speed does not show: with n samples lost between two, the axis has gone n*v*T
further than the integral of its speed over one period T. A sample that repeats the one before is n = -1, and the next
n = +1 if its time was right. The part of this difference due to a lag, an offset or noise of the speed changes slowly,
and is taken off by its running median. Where no speed is recorded, the running median of the steps replaces it.

Found samples are put right: stamps get the periods that are missing, and a recording with right stamps goes the way of
any other, a single missing sample interpolated, a longer loss a hole.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.gate.check import JITTER, Check, Repaired, Seen, absent, resolution_of
from bench.names import counted, percent
from bench.trace.time_base import HOLE, interpolate
from bench.trace.trace import Trace
from bench.trace.wraps import Wraps, jumps, period_of

NAME = "lost_samples"
#: Samples of the running median, and of the shortest stretch that is looked at.
WINDOW, SHORTEST = 9, 32
#: A jump is this many times above what all but one in twenty steps show, and above the position's resolution.
STANDS_OUT, STEPS = 6.0, 3.0
#: Without speed, it is also this many times above its neighbours: a jerk is no single jump.
ALONE = 4.0
#: Distance of a jump, in steps of the motion, from a whole number of them.
WHOLE = 0.3
#: Steps below this share of their RMS are too short for a loss to show, or to matter.
SLOW = 0.05
#: Share of lost samples that is refused, with speed and without: J stays within 1 % (`tests/gate/test_losses.py`).
MOST, MOST_BLIND = 0.01, 0.0005
#: Looks at the recording, each after what the last one found was put right: a jump hides others close by.
PASSES = 3
#: Chance that samples alike in every signal are no repetition.
CHANCE = 0.01
#: Signals that a sensor reports, of which a repeated sample repeats all.
SENSED = ("position", "velocity", "current", "torque", "force", "voltage")

ALLOWED = f"every sample once; up to {percent(MOST)} are put right"
ADVICE = "record with a buffer that loses none, or with time stamps of the drive itself"


def none_lost(seen: Seen) -> Check | Repaired:
    """The recording with lost and repeated samples put right."""
    trace = seen.trace
    if len(trace) < SHORTEST or not {"position", "velocity"} & set(trace.signals):
        return absent(NAME, "the recording is too short, or without motion", ALLOWED)
    if trace.time_base is not None and trace.time_base.resampled and trace.time_base.jitter > JITTER:
        return absent(NAME, "the times jitter: intervals between samples cannot show a loss", ALLOWED)
    right, lost, stale = trace, 0, 0
    most = (MOST if "velocity" in trace else MOST_BLIND) * len(trace)
    for _ in range(PASSES):
        missing, again = damage_of(right)
        in_time = (missing[:-1] < 0) & (missing[1:] > 0)  # a repeated sample replaces the one that is missing
        found_lost, found_stale = int(np.maximum(missing, 0).sum() - in_time.sum()), int(again.sum())
        lost, stale = lost + found_lost, stale + found_stale
        if lost + stale > most or not (found_lost or found_stale):
            break
        right = repaired(right, missing, again)
    if not lost and not stale:
        return Check(NAME, "pass", "none found", ALLOWED)
    found = f"{counted(lost, 'sample')} lost, {stale} repeated of {len(trace)}, though the time runs on evenly"
    if lost + stale > most:
        return Check(NAME, "fail", found, ALLOWED, ADVICE)
    return Check(NAME, "warn", f"{found}; put right", ALLOWED, ADVICE), right


def damage_of(trace: Trace) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Samples lost in each step, -1 where the next sample repeats this one (n - 1,); and which samples repeat what
    the one before has, in their position or in every signal (n,).
    """
    missing = np.zeros(len(trace) - 1, dtype=np.int64)
    parts = [part for part in trace.segments if part.stop - part.start >= SHORTEST] if "position" in trace else []
    jumps = [_beyond_motion(trace, part) for part in parts]
    if jumps:
        sizes = np.abs(np.concatenate([jump for jump, _ in jumps]))
        limit = max(STANDS_OUT * float(np.percentile(sizes, 95.0)), STEPS * resolution_of(trace["position"]))
        if sizes.max() > limit:
            usual = [_median(step) for _, step in jumps]
            least = SLOW * rms(np.concatenate(usual))
            for part, (jump, _), step in zip(parts, jumps, usual, strict=True):
                alone = _alone(jump) if "velocity" not in trace else True
                missing[part.start : part.stop - 1] = _whole_steps(jump, step, limit, least) * alone
    again = _repeated(trace)
    again[1:] |= missing < 0
    return missing, again


def _beyond_motion(trace: Trace, part: slice) -> tuple[Array, Array]:
    """What each step of the position has beyond the usual, and the motion's step - rad (m) - (n - 1,) each."""
    steps = np.diff(trace["position"][part])
    if "velocity" not in trace:
        return steps - _median(steps), steps
    velocity = trace["velocity"][part]
    travelled = (velocity[1:] + velocity[:-1]) / 2.0 * trace.sample_period
    beyond = steps - travelled
    return beyond - _median(beyond), travelled


def _median(values: Array) -> Array:
    """Of the neighbours of each value (n,); beyond an end that value is repeated."""
    around = np.lib.stride_tricks.sliding_window_view(np.pad(values, WINDOW // 2, mode="edge"), WINDOW)
    return np.partition(around, WINDOW // 2, axis=1)[:, WINDOW // 2]


def _whole_steps(jump: Array, step: Array, limit: float, least: float) -> NDArray[np.int64]:
    """How many steps of the motion a jump is, 0 where it is none."""
    sure = (np.abs(jump) > limit) & (np.abs(step) > least)
    ratio = np.divide(jump, step, out=np.zeros_like(jump), where=sure).clip(-jump.size, jump.size)
    whole = np.rint(ratio)
    near = np.abs(ratio - whole) < WHOLE * np.maximum(np.sqrt(np.abs(whole)), 1.0)
    return np.where(near & (whole >= -1.0), whole, 0.0).astype(np.int64)


def _alone(jump: Array) -> NDArray[np.bool_]:
    """Where a jump exceeds its neighbours; a repeated sample's two are adjacent."""
    size = np.pad(np.abs(jump), (4, 2))
    return np.abs(jump) > ALONE * np.maximum.reduce([size[:-6], size[1:-5], size[2:-4], size[6:]])


def _repeated(trace: Trace) -> NDArray[np.bool_]:
    """Which samples repeat the one before in every signal, more of them than chance makes."""
    names = [name for name in SENSED if name in trace and np.ptp(trace[name]) > 0.0]
    found = np.zeros(len(trace), dtype=bool)
    speed = np.abs(trace["velocity"][1:] if "velocity" in trace else np.diff(trace["position"]))
    moving = speed > SLOW * rms(speed)
    if len(names) < 2 or not moving.any():
        return found
    same = [np.diff(trace[name]) == 0.0 for name in names]
    all_same = np.logical_and.reduce(same) & moving
    by_chance = np.prod([np.mean((one & ~all_same)[moving]) for one in same]) * float(moving.sum())
    if by_chance < CHANCE:
        found[1:] = all_same
    return found


def repaired(trace: Trace, missing: NDArray[np.int64], again: NDArray[np.bool_]) -> Trace:
    """The recording with the times that its samples must have had, without repetitions, short gaps interpolated."""
    period = trace.sample_period
    step = np.diff(trace.time) + missing * period
    kept = ~again
    time = trace.time[0] + np.concatenate([[0.0], np.cumsum(step)])[kept]
    gap = np.diff(time) / period
    filled = np.flatnonzero((gap > HOLE) & (np.rint(gap) == 2.0))
    between = time[filled] + period
    order = np.argsort(np.concatenate([time, between]), kind="stable")
    signals = {}
    for name, values in trace.signals.items():
        known = values[kept]
        signals[name] = np.concatenate([known, interpolate(between, time, known)])[order]
    base = trace.time_base
    if base is not None:
        holes = np.flatnonzero(gap > HOLE + 1.0)
        filled_holes = tuple((float(time[k]), float(gap[k] * period)) for k in holes)
        base = replace(base, holes=filled_holes, interpolated=base.interpolated + filled.size)
    return replace(trace, time=np.concatenate([time, between])[order], signals=signals, time_base=base)


WRAPS = "position_wraps"
ALLOWED_WRAPS = "a position that runs on, or wraps by one period"
#: Periods beyond which a signal that wraps does not go, noise at its ends included.
LEAVES = 1.25


def runs_on(seen: Seen) -> Check | Repaired:
    """The recording with its wraps undone."""
    trace = seen.trace
    if "position" not in trace:
        return absent(WRAPS, "no position is recorded", ALLOWED_WRAPS)
    if trace.wraps is not None:
        return _undone(trace, trace.wraps)
    position = trace["position"]
    places = jumps(position, trace.time)
    if not places.size:
        return Check(WRAPS, "pass", "position runs on", ALLOWED_WRAPS)
    period = period_of(position, places)
    if period is None:
        longest = float(np.abs(np.diff(position)[places]).max())
        found = (
            f"position jumps {places.size} times, by up to {longest:.4g} {trace.units['position']}, not by one period"
        )
        advice = "record so that it runs on, cut the recording at the jumps, or omit the position"
        return Check(WRAPS, "fail", found, ALLOWED_WRAPS, advice)
    wraps = Wraps(period, int(places.size))
    wrapping = {"position": position}
    setpoint = trace.signals.get("position_reference")
    if setpoint is not None and np.ptp(setpoint) < LEAVES * period:  # one that runs on may step by more than a half
        wrapping["position_reference"] = setpoint
    unwrapped = {name: np.unwrap(values, period=period) for name, values in wrapping.items()}
    repaired = trace.with_signals(unwrapped, {})
    return _undone(trace, wraps), replace(repaired, wraps=wraps)


def _undone(trace: Trace, wraps: Wraps) -> Check:
    found = f"position wraps at {wraps.period:.5g} {trace.units['position']}; {counted(wraps.count, 'wrap')} undone"
    return Check(WRAPS, "pass", found, ALLOWED_WRAPS)
