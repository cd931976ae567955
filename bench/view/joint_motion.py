"""A joint along its log, measured and as its model moves: weakly coupled, and restarted every so often."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array, rms
from bench.diagnosis.diagnosis import Diagnosis
from bench.rig.rig import Rig
from bench.trace.motion import integrated, stretches_of, windows_of
from bench.trace.trace import Trace
from bench.view.free_running import BARE, HELD, restarted

#: Instants at most of which a motion is kept, to be drawn.
INSTANTS = 1000
#: How often a joint runs free again - s -, and instants of the curve over the longest.
EVERY, POINTS = (0.5, 5.0), 100


@dataclass(frozen=True)
class JointMotion:
    """A joint along a log, the rest of the robot as measured.

    Attributes:
        origin: of the log.
        unit: of its position.
        time: s (n,).
        measured: positions of all joints, by name - rad (m) - (n,).
        runs: positions of this one, by how its model was run - rad (m) - (n,).
        horizon, off: time since it was started - s -, and how far off it is then (RMS) - rad (m) - (k,).
    """

    origin: str
    unit: str
    time: Array
    measured: Mapping[str, Array]
    runs: Mapping[str, Array]
    horizon: Array
    off: Array


def joint_motion(
    found: Diagnosis, trace: Trace, rig: Rig, poses: tuple[Array, Mapping[str, Array]]
) -> JointMotion | None:
    """The motion of a diagnosed joint; None where its model does not move, or runs away from the log.

    The trace begins the first recording of the diagnosis; `poses` are where the robot's joints were at times of the log
    - s, rad (m).
    """
    series, count = found.time_series[0], len(trace)
    held = {HELD: series.velocity_residuals[-1], BARE: series.velocity_residuals[0] if found.effects else None}
    if held[HELD] is None or not np.array_equal(series.time[:count], trace.time):
        return None
    runs = {how: _position(series.velocity - left, trace) for how, left in held.items() if left is not None}
    free, ratio = restarted(found, trace, rig, EVERY), rig.gear_ratio
    few = np.linspace(trace.time[0], trace.time[-1], min(count, INSTANTS))
    return JointMotion(
        trace.origin,
        rig.axis_kind.length_unit,
        few,
        {name: np.interp(few, poses[0], one) for name, one in poses[1].items()},
        {how: np.interp(few, trace.time, one) / ratio for how, one in {**runs, **free}.items()},
        *_horizon(free, trace, ratio),
    )


def _position(velocity: Array, trace: Trace) -> Array:
    """By a model's speed, from where each stretch without holes begins - rad (m) - (n,); nan where it is not known."""
    position = np.full(len(trace), np.nan)
    for part in stretches_of(trace):
        position[part] = trace["position"][part.start] + integrated(velocity[part], trace.sample_period)
    return position


def _horizon(free: Mapping[str, Array], trace: Trace, ratio: float) -> tuple[Array, Array]:
    """How far off a joint is over the time since it was started, of the longest windows; both empty without one."""
    if not free:
        return np.zeros(0), np.zeros(0)
    *_, (every, position) = zip(EVERY, free.values(), strict=False)
    length = round(every / trace.sample_period)
    whole = [part for part in windows_of(trace, every) if part.stop - part.start == length]
    off = np.array([position[part] - trace["position"][part] for part in whole]) / ratio
    at = np.unique(np.linspace(0, length - 1, POINTS).astype(int))
    return trace.sample_period * at, np.array([rms(off[:, k]) for k in at])
