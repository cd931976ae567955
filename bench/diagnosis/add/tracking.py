"""Velocity gap: recorded velocity less that of a model that tracks the recording with low gains."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.diagnosis.add.extension import Stage
from bench.diagnosis.add.model import without_events
from bench.plant.measured_motion import in_stretches, measured_velocity
from bench.plant.model_file import StoredModel
from bench.plant.soft_tracking import Held, track_all
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Type of residuals kept for every addition: half the memory, and never summed.
Left = NDArray[np.float32]


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
        cls,
        name: str,
        trace: Trace,
        rig: Rig,
        since: float = -np.inf,
        until: float = np.inf,
        events: bool = True,
    ) -> Recorded:
        """A recording whose gap is taken from `since` until `until` - s."""
        judged = (trace.time >= since) & (trace.time < until) & in_stretches(trace)
        return cls(name, trace, rig.net_effort(trace)[0], judged, events)

    def difference(self, simulated: Array) -> Array:
        """Simulated less measured velocity at the judged samples - rad/s (m/s)."""
        return (simulated - measured_velocity(self.trace))[self.judged]

    def left(self, simulated: Array) -> Left:
        """Measured less simulated velocity at every sample, for display - rad/s (m/s) - (n,)."""
        return (measured_velocity(self.trace) - simulated).astype(np.float32)

    @property
    def varies(self) -> float:
        """Standard deviation of the measured velocity: a larger gap means no tracking at all - rad/s (m/s)."""
        return float(np.std(measured_velocity(self.trace)[self.judged]))

    def holding(self, stored: StoredModel, inertia: float) -> Held:
        """A model that tracks it by a cascade designed for an inertia - kg*m**2 (kg)."""
        model = stored.model if self.events else without_events(stored.model)
        return Held(model, self.trace, self.effort, stored.misalignment, inertia)


def gap_of(recorded: Recorded, velocity: Array | None) -> float:
    """RMS of measured less simulated velocity - rad/s (m/s); nan where there is none."""
    return float("nan") if velocity is None else rms(recorded.difference(velocity))


class VelocityGaps:
    """Velocity gaps of models along recordings, each simulated once.

    Args:
        bandwidth: of the tracking cascade - rad/s.
        inertia: for which the cascade is designed - kg*m**2 (kg).
    """

    def __init__(self, bandwidth: float, inertia: float) -> None:
        self.bandwidth, self.inertia = bandwidth, inertia
        self._known: dict[tuple[object, ...], float] = {}
        self._left: dict[tuple[object, ...], Left] = {}

    def simulate(self, pairs: Iterable[tuple[Stage, Recorded]]) -> None:
        """Simulate models along recordings in parallel, unless done before."""
        asked = {self._key(*pair): pair for pair in pairs}
        new = {key: pair for key, pair in asked.items() if key not in self._known}
        self._known |= dict.fromkeys(new, float("nan"))
        run = {key: pair for key, pair in new.items() if pair[0].model is not None}
        recordings = [recorded for _, recorded in run.values()]
        velocities = self.velocities([m for m in (stage.model for stage, _ in run.values()) if m], recordings)
        for key, recorded, velocity in zip(run, recordings, velocities, strict=True):
            self._known[key] = gap_of(recorded, velocity)
            if velocity is not None:
                self._left[key] = recorded.left(velocity)

    def of(self, stage: Stage, recorded: Recorded) -> float:
        """RMS of measured less simulated velocity - rad/s (m/s); nan without a model, or where it diverged."""
        self.simulate([(stage, recorded)])
        return self._known[self._key(stage, recorded)]

    def of_models(self, models: Iterable[StoredModel | None], recordings: Iterable[Recorded]) -> list[float]:
        """Gaps of models along recordings, one each."""
        recordings = list(recordings)
        simulated = self.velocities([m for m in models if m is not None], recordings)
        return [gap_of(recorded, velocity) for recorded, velocity in zip(recordings, simulated, strict=True)]

    def left(self, stage: Stage, recorded: Recorded) -> Left | None:
        """Measured less simulated velocity along a recording; None without a model, or where it diverged."""
        self.simulate([(stage, recorded)])
        return self._left.get(self._key(stage, recorded))

    def velocities(self, models: Iterable[StoredModel], recordings: Iterable[Recorded]) -> list[Array | None]:
        """Velocities of models along recordings, one each, (n,) - rad/s (m/s); None where one diverged."""
        held = [r.holding(model, self.inertia) for model, r in zip(models, recordings, strict=True)]
        return [None if each is None else each.velocity for each in track_all(held, self.bandwidth)]

    def _key(self, stage: Stage, recorded: Recorded) -> tuple[object, ...]:
        return (stage.rows, tuple(term.key for term in stage.fitted.terms), stage.beside, recorded.name)
