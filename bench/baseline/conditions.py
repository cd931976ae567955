"""What a state was recorded under, so that another motion or rig is not taken for another axis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from bench.arrays import rms
from bench.comparison.difference import Measured
from bench.plant.measured_motion import measured_velocity
from bench.rig.rig import Rig
from bench.rig.values import tolerance_of
from bench.trace.trace import Trace

#: Factor within which conditions count as equal.
ALIKE = 1.1
#: Recorded but not compared: a changed axis needs another effort, and the cut-off follows the noise.
FOLLOWING = frozenset({"rms_effort", "cutoff"})
#: Window over which speed is averaged before it is differentiated - s.
SMOOTH = 0.02
#: Tables and keys of a rig that no result depends on: its name, the truth of a simulation, what a check allows, and the
#: drive, whose effect on the motion is compared separately.
BESIDE = {"name", "simulation", "check", "drive", "source"}


def conditions(traces: Sequence[Trace], rig: Rig, cutoff: float) -> dict[str, Measured]:
    """Motion, sampling and cut-off of recordings, their mean where there are several; SI.

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
    measured = {name: Measured(value, unit) for (name, unit), value in zip(units.items(), found, strict=True)}
    return measured | {"cutoff": Measured(cutoff, "Hz")}


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
    for name in (name for name in baseline if name in now and name not in FOLLOWING):
        before, after = baseline[name].value, now[name].value
        if not before / ALIKE <= after <= before * ALIKE:
            lines.append(f"{name.replace('_', ' ')}: {before:.4g} -> {after:.4g} {baseline[name].unit}")
    return lines


def rig_values(rig: Rig) -> dict[str, str]:
    """The keys that identification reads of a rig, dotted, with their values as text in SI."""
    found = dict(_flat("", rig.model_dump(exclude=BESIDE)))
    if rig.drive is not None:
        found["drive.control_period"] = _text(rig.drive.control_period)
    return found


def _flat(place: str, value: object) -> Iterator[tuple[str, str]]:
    """Values of tables within tables that are given, each with its place."""
    if isinstance(value, Mapping):
        for key, part in value.items():
            yield from _flat(f"{place}.{key}" if place else key, part)
    elif isinstance(value, list | tuple):
        for number, part in enumerate(value):
            yield from _flat(f"{place}[{number}]", part)
    elif value is not None:
        yield place, _text(value)


def _text(value: object) -> str:
    if not isinstance(value, float):
        return str(value)
    tolerance = tolerance_of(value)
    return f"{float(value):.9g} +/- {tolerance:.3g}" if tolerance else f"{value:.9g}"


def differing(baseline: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    """A line for each key of two rigs that differs."""
    return [
        f"{key}: {baseline.get(key, 'not given')} -> {now.get(key, 'not given')}"
        for key in dict.fromkeys([*baseline, *now])
        if baseline.get(key) != now.get(key)
    ]
