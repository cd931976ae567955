"""Do the signals move, all the time and within their range, in steps fine enough?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.gate.check import EFFORTS, Check, Seen, absent, least_squares, resolution_of
from bench.names import percent
from bench.rig.rig import Rig
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

MOVES, CLIPS, RESOLUTION = "signal_moves", "signal_clips", "resolution"
MOTION = ("position", "velocity")
#: Equal values in a row that are no chance in a signal whose noise is at least so many of its steps: 0.28**50 = 2e-28.
IN_A_ROW, NOISY = 50, 1.0
#: Second difference of a signal's changes over these, in the middle, below which it has no noise; white noise has 3.
SMOOTH = 0.05
#: Steps of a position, and share of all its travel, that it must have gone by its speed meanwhile.
TRAVELLED, OF_ALL = 20.0, 0.02
#: Share of all samples that stand still to be refused.
FROZEN = 0.005
#: Standard deviation of a position, in those of its noise or in its steps, up to which the axis stands still.
STILL = 1.2
#: Spread of speed, as share of its RMS, below which the axis keeps one speed.
STEADY = 0.1
#: Speed, as share of its RMS, above which an axis moves.
MOVING = 0.5
#: Share of samples that are exactly the largest value, in rows of so many, which no motion and no noise make.
CLIPPED, ROW = 0.005, 5
#: Distance from the drive's own limit within which standing there is the drive's doing and the value true.
AT_LIMIT = 0.02
#: Share of the largest value by which the motion must ask for more, for what lies beyond to be lost; and the windows.
BEYOND, WINDOWS = 0.05, 8
#: The same of a signal at zero, as a share of its mean size elsewhere.
DROPPED = 0.3
#: Samples of these windows: short, to lie within a clipped stretch.
SHORT = (4, 16)
#: Steps within a signal's spread that are reported, and refused.
FINE, COARSE = 8.0, 1.0
#: Samples from which a spread is meaningful.
LEAST = 64

ALLOWED_MOVES = "motion and effort that change, and no sensor that stands still meanwhile"
ALLOWED_CLIPS = "no signal that stays at the end of its range"
ALLOWED_STEPS = f"{FINE:g} steps within the spread of motion and of effort"


def moves(seen: Seen) -> Check:
    """Whether motion and effort change at all, and all the time."""
    trace = seen.trace
    motion = [name for name in MOTION if name in trace]
    efforts = [name for name in EFFORTS if name in trace]
    still = [names for names in (motion, efforts) if names and not any(np.ptp(trace[name]) > 0.0 for name in names)]
    if "position" in trace and not still:
        position = trace["position"]
        if float(np.std(position)) <= STILL * max(white_noise(position), resolution_of(position)):
            still = [motion]
    if still:
        noise = " but noise" * any(np.ptp(trace[name]) > 0.0 for names in still for name in names)
        found = f"{' and '.join(' and '.join(names) for names in still)} without any change{noise}"
        advice = "record while the axis moves, and the signal that the motor's torque follows"
        # at one speed an effort may be one number; the fit judges that better
        status = "warn" if efforts in still and _steady(seen) else "fail"
        return Check(MOVES, status, found, ALLOWED_MOVES, advice, unanswerable=True)
    frozen = {name: count for name in (*motion, *efforts) if (count := _frozen(trace, name))}
    if not frozen:
        return Check(MOVES, "pass", ", ".join((*motion, *efforts)), ALLOWED_MOVES)
    name = max(frozen, key=lambda one: frozen[one])
    found = f"{name} stands still for {frozen[name] * trace.sample_period:.3g} s while the axis moves"
    status = "fail" if frozen[name] > FROZEN * len(trace) else "warn"
    return Check(MOVES, status, found, ALLOWED_MOVES, "check the sensor, or cut the recording there")


def _steady(seen: Seen) -> bool:
    """Whether the axis keeps one speed."""
    speeds = [seen.speed(part) for part in seen.trace.segments if part.stop - part.start > 1 and seen.tells_motion]
    every = np.concatenate(speeds) if speeds else np.zeros(1)
    return float(np.std(every)) <= STEADY * rms(every)


def _frozen(trace: Trace, name: str) -> int:
    """Samples in which a signal stands still though it cannot: the axis moves, and its own noise is above its steps."""
    values = trace[name]
    starts, lengths = _runs(np.diff(values) == 0.0)
    long = lengths >= IN_A_ROW
    if not long.any():
        return 0
    starts, lengths = starts[long], lengths[long]
    step = resolution_of(values)
    speed = trace["velocity"] if "velocity" in trace else np.gradient(trace["position"], trace.sample_period)
    moved = np.concatenate([[0.0], np.cumsum(speed)])
    mean = np.abs(moved[starts + lengths] - moved[starts]) / lengths
    moving = mean > MOVING * rms(speed)
    if name == "position":
        gone = mean * lengths * trace.sample_period
        least = max(TRAVELLED * step, OF_ALL * float(np.ptp(values)))
        return int(lengths[moving & (gone > least)].sum()) if "velocity" in trace else 0
    if white_noise(values) < NOISY * step or _noise_free(values) or _in_steps(values):
        return 0
    off_or_rail = (values[starts] == 0.0) | (values[starts] == values.max()) | (values[starts] == values.min())
    return int(lengths[moving & ~off_or_rail].sum())


def _noise_free(values: Array) -> bool:
    """Whether most changes (n - 1,) are as the ones before them, as those of a computed signal are."""
    steps = np.diff(values)
    changing = np.abs(steps[1:-1]) + np.abs(steps[:-2]) + np.abs(steps[2:]) > 0.0
    bend = np.abs(steps[2:] - 2.0 * steps[1:-1] + steps[:-2])[changing]
    return bend.size > 0 and float(np.median(bend)) < SMOOTH * float(np.median(np.abs(steps[1:-1][changing])))


def _in_steps(values: Array) -> bool:
    """Whether most changes stand alone, as those of a command; after one of noise that is a step another is 0.72."""
    changed = np.diff(values) != 0.0
    return bool(2 * np.count_nonzero(changed[1:] & changed[:-1]) < np.count_nonzero(changed[:-1]))


def _runs(standing: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Starts and lengths of the stretches that are true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], standing, [False]]).astype(np.int8)))
    return edges[::2], edges[1::2] - edges[::2]


def clips(seen: Seen) -> Check:
    """Whether a signal stays at the end of its range."""
    names = [name for name in ("current", "torque", "force", "velocity") if name in seen.trace]
    if not names:
        return absent(CLIPS, "no speed or effort is recorded", ALLOWED_CLIPS)
    sides = [_stands(seen, name, side) for name in names for side in (1.0, -1.0, 0.0)]
    faults = [found for found in sides if found is not None]
    worst = next((one for one in faults if one.status == "fail"), faults[0] if faults else None)
    return worst or Check(CLIPS, "pass", "none found", ALLOWED_CLIPS)


def _stands(seen: Seen, name: str, side: float) -> Check | None:
    """What is wrong with a signal at the upper end of its range, the lower one at a side of -1, or zero at one of 0."""
    trace = seen.trace
    standing = None if name == "velocity" and not side else _standing(trace, seen.rig, name, side)  # an axis may rest
    if standing is None:
        return None
    where, samples, ends = standing
    lost = name != "velocity" and _more_demanded(seen, name, samples, side)
    if not side and not lost:
        return None  # a motor that coasts has no current
    begin, end = (trace.time[k] - trace.time[0] for k in ends)
    found = f"{where}, between {begin:.4g} and {end:.4g} s"
    advice = "the end of its range? What lies beyond is lost: record with a wider range, or move more gently"
    advice = advice if side else "the signal dropped out? The motion takes effort meanwhile: cut the recording there"
    return Check(CLIPS, "fail" if lost else "warn", found, ALLOWED_CLIPS, advice, unanswerable=True)


def _standing(
    trace: Trace, rig: Rig | None, name: str, side: float
) -> tuple[str, NDArray[np.bool_], tuple[int, int]] | None:
    """Where a signal stays at an end of its range, as of `_stands`; None where hardly, or at the drive's own limit.

    In words, the samples at which it does (n,), and the first and the last in long rows of them.
    """
    values = side * trace[name]
    top = float(values.max())
    peak = rig.motor.peak_current if rig is not None and name == "current" else None
    if side and (top <= 0.0 or (peak is not None and abs(top / peak - 1.0) < AT_LIMIT)):
        return None
    samples = values == top if side else trace[name] == 0.0
    starts, lengths = _runs(samples)
    starts, lengths = starts[lengths >= ROW], lengths[lengths >= ROW]
    share = float(lengths.sum()) / len(trace)
    if share <= CLIPPED:
        return None
    where = f"{percent(share)} of {name} are exactly {side * top + 0.0:.4g} {trace.units[name]}"
    return where, samples, (int(starts[0]), int(starts[-1] + lengths[-1] - 1))


def clipped(trace: Trace, rig: Rig) -> list[str]:
    """A warning of each end of its range at which a signal of the effort stays."""
    names = [name for name in ("current", "torque", "force") if name in trace]
    ends = (_standing(trace, rig, name, side) for name in names for side in (1.0, -1.0))
    return [f"{end[0]}: the end of its range? What lies beyond is lost" for end in ends if end is not None]


def _more_demanded(seen: Seen, name: str, standing: NDArray[np.bool_], side: float) -> bool:
    """Whether the motion, by the axis' values in the other windows, takes more effort than is recorded, or other."""
    fitted = seen.balance(SHORT) if seen.effort is not None and seen.effort[1] == name else None
    if fitted is None:
        return False
    counted = np.concatenate([[0], np.cumsum(standing)])
    inside = (counted[fitted.starts + fitted.length] - counted[fitted.starts]) / fitted.length
    clear, full = inside == 0.0, inside > 0.9
    if full.sum() < WINDOWS or clear.sum() < WINDOWS * fitted.columns.shape[1]:
        return False
    beyond = fitted.columns[full] @ least_squares(fitted.columns[clear], fitted.effort[clear]) - fitted.effort[full]
    most = float(np.abs(fitted.effort[full if side else clear]).mean())
    return float(np.median(side * beyond) if side else np.abs(beyond).mean()) > (BEYOND if side else DROPPED) * most


def resolution(seen: Seen) -> Check:
    """Whether motion and effort come in steps fine enough."""
    trace = seen.trace
    if trace.time_base is not None and trace.time_base.resampled:
        return absent(RESOLUTION, "interpolated onto regular times, which hides its steps", ALLOWED_STEPS)
    if len(trace) < LEAST:
        return absent(RESOLUTION, f"only {len(trace)} samples", ALLOWED_STEPS)
    steps = {}
    for what, names in (("motion", MOTION), ("effort", EFFORTS)):
        changing = [trace[name] for name in names if name in trace and np.ptp(trace[name]) > 0.0]
        if changing:
            steps[what] = max(float(np.std(values)) / resolution_of(values) for values in changing)
    if not steps:
        return absent(RESOLUTION, "nothing moves", ALLOWED_STEPS)
    counts = ((what, f"{count:.0f}" if 100.0 <= count < 1e6 else f"{count:.3g}") for what, count in steps.items())
    found = ", ".join(f"{count} steps within the spread of the {what}" for what, count in counts)
    worst = min(steps.values())
    advice = "record in finer steps, or a larger motion"
    if worst < COARSE:
        return Check(RESOLUTION, "fail", found, ALLOWED_STEPS, advice, unanswerable=True)
    return Check(RESOLUTION, "warn" if worst < FINE else "pass", found, ALLOWED_STEPS, advice * (worst < FINE))
