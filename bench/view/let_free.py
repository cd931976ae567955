"""A model let free: begun as the sensors have the axis, driven by the recorded torque, and held by nothing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.arrays import Array, rms
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.replay import driven, parts_of
from bench.plant.tracking import run_free
from bench.rig.rig import Rig
from bench.trace.motion import measured_position, measured_velocity, stretches_of
from bench.trace.trace import Trace

#: Longest that it is let free - s -, and how many windows begin within the length of one.
LONGEST, BEGIN = 5.0, 4


@dataclass(frozen=True)
class FreeRun:
    """How far off a model runs, over the time since it was let free.

    Attributes:
        time: since then - s (n,).
        position, velocity: RMS over windows of simulated less measured - rad (m), rad/s (m/s) - (n,).
        windows: how many.
    """

    time: Array
    position: Array
    velocity: Array
    windows: int


def let_free(model: Diagnosis | str | Path, trace: Trace, rig: Rig) -> FreeRun | None:
    """Run a model from many moments of a recording by itself; None where it holds no motion.

    Windows of 5 s, or of half of the longest stretch without holes, begin every quarter of one. Noise of the sensors at
    the moment at which a window begins stays in its motion.

    Raises:
        InputError: as `bench.replay`.
        SimulationError: the model diverged.
    """
    _, _, balance, stored = parts_of(model, rig)
    if stored is None:
        return None
    stretches = stretches_of(trace)
    length = min(round(LONGEST / trace.sample_period) + 1, max(part.stop - part.start for part in stretches) // 2)
    every = max(length // BEGIN, 1)
    windows = [slice(k, k + length) for part in stretches for k in range(part.start, part.stop - length + 1, every)]
    runs = run_free(driven(stored, balance, trace, rig.own_effort(trace)[0]), windows)
    position, velocity = measured_position(trace), measured_velocity(trace)
    begun = [0.0 if "position" in trace else position[part.start] for part in windows]  # else an integral from zero
    off = [one.position + at - position[part] for one, at, part in zip(runs, begun, windows, strict=True)]
    late = [one.velocity - velocity[part] for one, part in zip(runs, windows, strict=True)]
    time = trace.sample_period * np.arange(length, dtype=np.float64)
    position_off, velocity_off = (np.array([rms(column) for column in np.transpose(each)]) for each in (off, late))
    return FreeRun(time, position_off, velocity_off, len(windows))
