"""Conditions of recordings: motion, sampling and cut-off, so that another motion is not taken for another axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.arrays import rms
from bench.comparison.difference import Measured
from bench.plant.measured_motion import measured_velocity
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Factor within which conditions count as equal.
ALIKE = 1.1
#: Recorded but not compared: a changed axis needs another effort, and the cut-off follows the noise.
FOLLOWING = frozenset({"rms_effort", "cutoff"})
#: Window over which speed is averaged before it is differentiated - s.
SMOOTH = 0.02


def conditions(traces: Sequence[Trace], rig: Rig, cutoff: float) -> dict[str, Measured]:
    """Conditions of recordings, their mean where there are several; SI.

    Args:
        traces: the recordings.
        rig: of the axis.
        cutoff: half-power frequency of the filter - Hz.
    """
    kind = rig.axis_kind
    units = {
        "top_speed": kind.speed_unit,
        "rms_speed": kind.speed_unit,
        "rms_acceleration": kind.acceleration_unit,
        "rms_effort": rig.net_effort(traces[0])[1],
        "duration": "s",
        "sample_period": "s",
    }
    found = np.mean([_of(trace, rig) for trace in traces], axis=0).tolist()
    measured = {name: Measured(value, unit, 0.0) for (name, unit), value in zip(units.items(), found, strict=True)}
    return measured | {"cutoff": Measured(cutoff, "Hz", 0.0)}


def _of(trace: Trace, rig: Rig) -> list[float]:
    speed, period = measured_velocity(trace), trace.sample_period
    width = max(1, round(SMOOTH / period))
    slopes = [np.zeros(1)]
    for part in trace.segments:
        if part.stop - part.start > 2 * width:
            smooth = np.convolve(speed[part], np.full(width, 1.0 / width), "valid")
            slopes.append(np.gradient(smooth, period))
    top = float(np.quantile(np.abs(speed), 0.99))  # robust against one glitch
    duration = float(trace.time[-1] - trace.time[0])
    return [top, rms(speed), rms(np.concatenate(slopes)), rms(rig.net_effort(trace)[0]), duration, period]


def unlike(baseline: Mapping[str, Measured], now: Mapping[str, Measured]) -> list[str]:
    """A line for each condition that differs."""
    lines = []
    for name in baseline:
        if name in FOLLOWING or name not in now:
            continue
        before, after = baseline[name].value, now[name].value
        if not before / ALIKE <= after <= before * ALIKE:
            lines.append(f"{name.replace('_', ' ')}: {before:.4g} -> {after:.4g} {baseline[name].unit}")
    return lines
