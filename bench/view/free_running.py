"""Motions of a model that are drawn with its recording: free-running, restarted periodically, without its effects.

A free-running simulation begins at the measured position and speed, and only the recorded torque drives it.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.arrays import Array, rms
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.model import holding_bandwidth, tracking
from bench.diagnosis.replay import parts_of
from bench.errors import SimulationError
from bench.fit.stored import EVERY
from bench.plant.tracking import SoftTracking, Tracked, run_free, track
from bench.rig.rig import Rig
from bench.trace.motion import measured_position, measured_velocity, stretches_of, windows_of
from bench.trace.trace import Trace

#: Longest free run - s -, and how many windows begin within the length of one.
LONGEST, BEGIN = 5.0, 4
#: Times after which a simulation is restarted, where its error is shown - s.
HORIZONS = (0.5, 1.0, 2.0, 5.0)
#: Names of the motions that a weak cascade keeps near the recording, with and without the effects.
HELD, BARE = "weakly coupled", "weakly coupled, without the effects found"


@dataclass(frozen=True)
class FreeRun:
    """Error of a free-running model over the time since its start.

    Attributes:
        time: since then - s (n,).
        position, velocity: RMS over windows of simulated less measured - rad (m), rad/s (m/s) - (n,).
        windows: how many.
    """

    time: Array
    position: Array
    velocity: Array
    windows: int


def free_run(model: Diagnosis | str | Path, trace: Trace, rig: Rig) -> FreeRun | None:
    """Simulate a model from many moments of a recording; None where it contains no motion.

    Windows of 5 s, or of half of the longest stretch without holes, begin every quarter of one. Noise of the sensors at
    the moment at which a window begins stays in its motion.

    Raises:
        InputError: as `bench.replay`.
        SimulationError: the model diverged.
    """
    held = _held(model, trace, rig)
    if held is None:
        return None
    stretches = stretches_of(trace)
    length = min(round(LONGEST / trace.sample_period) + 1, max(part.stop - part.start for part in stretches) // 2)
    every = max(length // BEGIN, 1)
    windows = [slice(k, k + length) for part in stretches for k in range(part.start, part.stop - length + 1, every)]
    position, velocity, runs = measured_position(trace), measured_velocity(trace), _free(held, windows)
    off = [one.position - position[part] for one, part in zip(runs, windows, strict=True)]
    late = [one.velocity - velocity[part] for one, part in zip(runs, windows, strict=True)]
    time = trace.sample_period * np.arange(length, dtype=np.float64)
    position_off, velocity_off = (np.array([rms(column) for column in np.transpose(each)]) for each in (off, late))
    return FreeRun(time, position_off, velocity_off, len(windows))


def restarted(
    model: Diagnosis | str | Path, trace: Trace, rig: Rig, horizons: Sequence[float] = HORIZONS
) -> dict[str, Array]:
    """Positions of a model that is restarted periodically, by the period - rad (m) - (n,).

    None of them where the model contains no motion, the recording is shorter, or the model diverged.

    Raises:
        InputError: as `bench.replay`.
    """
    held, found = _held(model, trace, rig), dict[str, Array]()
    if held is None:
        return found
    for horizon in horizons:
        windows, position = windows_of(trace, horizon), np.full(len(trace), np.nan)
        if not any(part.stop - part.start == round(horizon / trace.sample_period) for part in windows):
            continue
        with suppress(SimulationError):
            for part, one in zip(windows, _free(held, windows), strict=True):
                position[part] = one.position
            found[f"restarted every {horizon:g} s"] = position
    return found


def without_effects(model: Diagnosis | str | Path, trace: Trace, rig: Rig) -> Array | None:
    """Position of a model without its effects, weakly coupled - rad (m) - (n,); None where it has none, or diverged.

    Raises:
        InputError: as `bench.replay`.
    """
    held = _held(model, trace, rig)
    if held is None or not held.model.effects:
        return None
    without, top = held.model.with_effects([]), float(np.nanmax(np.abs(measured_velocity(trace))))
    with suppress(SimulationError):
        return track(replace(held, model=without), holding_bandwidth(without, top)).position
    return None


def _held(model: Diagnosis | str | Path, trace: Trace, rig: Rig) -> SoftTracking | None:
    """A model and what drives it along a recording; None where it contains no motion."""
    _, _, balance, stored = parts_of(model, rig)
    return None if stored is None else tracking(stored, trace, rig, balance.recording in (EVERY, trace.origin))


def _free(held: SoftTracking, windows: Sequence[slice]) -> list[Tracked]:
    """Its motion in windows, in the recording's position."""
    runs, position = run_free(held, windows), measured_position(held.trace)
    if "position" in held.trace:
        return runs
    begun = (position[part.start] for part in windows)  # a run counts from zero, as an integral does
    return [replace(one, position=one.position + at) for one, at in zip(runs, begun, strict=True)]
