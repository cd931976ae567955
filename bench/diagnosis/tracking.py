"""Velocity gap: recorded velocity less that of a model that tracks the recording with low gains; held-out motion."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.diagnosis.model import Stage, without_events
from bench.diagnosis.recordings import Recordings
from bench.fit.rows import Rows
from bench.plant.measured_motion import in_stretches, measured_velocity
from bench.plant.model_file import StoredModel
from bench.plant.tracking import SoftTracking, track_all
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Share of a recording, at its end, that is held out if there is no holdout recording.
HELD_OUT = 1.0 / 3.0
#: Names of fitted and of judging motion.
RECORDING, FIRST_PART = "recording", "first two thirds of the recording"
HOLDOUT, LAST_THIRD = "holdout", "last third of the recording"
#: Velocities that are kept for every addition: half the memory, and never summed.
Residual = NDArray[np.float32]


@dataclass(frozen=True)
class Recorded:
    """A recording for models to track.

    Attributes:
        name: of it.
        trace: the recording.
        effort: (n,) - N*m (N).
        judged: (n,) samples over which the gap is taken.
        events: whether the model's events occur in it.
    """

    name: str
    trace: Trace
    effort: Array
    judged: NDArray[np.bool_]
    events: bool = True

    @classmethod
    def of(
        cls, name: str, trace: Trace, rig: Rig, since: float = -np.inf, until: float = np.inf, events: bool = True
    ) -> Recorded:
        """A recording whose gap is taken from `since` until `until` - s."""
        judged = (trace.time >= since) & (trace.time < until) & in_stretches(trace)
        return cls(name, trace, rig.net_effort(trace)[0], judged, events)

    def difference(self, simulated: Array) -> Array:
        """Simulated less measured velocity at the judged samples - rad/s (m/s)."""
        return (simulated - measured_velocity(self.trace))[self.judged]

    def gap(self, simulated: Array | None) -> float:
        """RMS of measured less simulated velocity at the judged samples - rad/s (m/s); nan where there is none."""
        return math.nan if simulated is None else rms(self.difference(simulated))

    def residual(self, simulated: Array) -> Residual:
        """Measured less simulated velocity at every sample, for display - rad/s (m/s) - (n,)."""
        return (measured_velocity(self.trace) - simulated).astype(np.float32)

    @property
    def varies(self) -> float:
        """Standard deviation of the measured velocity: a larger gap means no tracking at all - rad/s (m/s)."""
        return float(np.std(measured_velocity(self.trace)[self.judged]))

    def holding(self, stored: StoredModel, inertia: float) -> SoftTracking:
        """A model that tracks it by a cascade designed for an inertia - kg*m**2 (kg)."""
        model = stored.model if self.events else without_events(stored.model)
        return SoftTracking(model, self.trace, self.effort, stored.misalignment, inertia)


class VelocityGaps:
    """Velocity gaps of models along recordings, each simulated once.

    Args:
        bandwidth: of the tracking cascade - rad/s.
        inertia: for which the cascade is designed - kg*m**2 (kg).
    """

    def __init__(self, bandwidth: float, inertia: float) -> None:
        self.bandwidth, self.inertia = bandwidth, inertia
        self._known: dict[tuple[object, ...], tuple[float, Residual | None]] = {}

    def simulate(self, pairs: Iterable[tuple[Stage, Recorded]]) -> None:
        """Simulate models along recordings in parallel, unless done before."""
        asked = {_key(stage, recorded): (stage.model, recorded) for stage, recorded in pairs}
        new = {key: pair for key, pair in asked.items() if key not in self._known}
        run = {key: (model, recorded) for key, (model, recorded) in new.items() if model is not None}
        velocities = self.velocities([model for model, _ in run.values()], [recorded for _, recorded in run.values()])
        self._known |= dict.fromkeys(new, (math.nan, None))
        for (key, (_, recorded)), velocity in zip(run.items(), velocities, strict=True):
            self._known[key] = recorded.gap(velocity), None if velocity is None else recorded.residual(velocity)

    def of(self, stage: Stage, recorded: Recorded) -> float:
        """RMS of measured less simulated velocity - rad/s (m/s); nan without a model, or where it diverged."""
        self.simulate([(stage, recorded)])
        return self._known[_key(stage, recorded)][0]

    def residual(self, stage: Stage, recorded: Recorded) -> Residual | None:
        """Measured less simulated velocity along a recording; None without a model, or where it diverged."""
        self.simulate([(stage, recorded)])
        return self._known[_key(stage, recorded)][1]

    def velocities(self, models: Iterable[StoredModel], recordings: Iterable[Recorded]) -> list[Array | None]:
        """Velocities of models along recordings, one each, (n,) - rad/s (m/s); None where one diverged."""
        held = [r.holding(model, self.inertia) for model, r in zip(models, recordings, strict=True)]
        return [None if each is None else each.velocity for each in track_all(held, self.bandwidth)]


def _key(stage: Stage, recorded: Recorded) -> tuple[object, ...]:
    return (stage.rows, tuple(term.key for term in stage.fitted.terms), stage.outside, recorded.name)


@dataclass(frozen=True)
class HeldOut:
    """Motion by which additions are judged; the judged fits do not use it.

    Attributes:
        fitted: rows that judged fits use.
        rows: their name.
        judge: rows they are judged by.
        recorded: the same for simulations.
        seen: motion that simulations may be fitted to.
    """

    fitted: Rows
    rows: str
    judge: Rows
    recorded: Recorded
    seen: Recorded

    @classmethod
    def of(cls, recordings: Recordings, trusted: bool, events: bool) -> HeldOut:
        """A holdout that is `trusted` to be of this axis, with the recording's events or not; else the last third."""
        if recordings.holdout is not None and recordings.holdout_rows is not None and trusted:
            recorded = Recorded.of(HOLDOUT, recordings.holdout, recordings.rig, events=events)
            seen = Recorded.of(RECORDING, recordings.trace, recordings.rig)
            return cls(recordings.rows, RECORDING, recordings.holdout_rows, recorded, seen)
        time = recordings.trace.time
        split = float(time[0] + (1.0 - HELD_OUT) * (time[-1] - time[0]))
        recorded = Recorded.of(LAST_THIRD, recordings.trace, recordings.rig, split)
        smooth, after = recordings.rows.conditioning.filter, split - time[0]
        away = smooth.margin * smooth.sample_period  # within which the filter mixes both sides
        fitted = recordings.rows.selected(lambda time: time < after - away)
        judge = recordings.rows.selected(lambda time: time >= after + away)
        seen = Recorded.of(FIRST_PART, recordings.trace, recordings.rig, until=split)
        return cls(fitted, FIRST_PART, judge, recorded, seen)
