"""Velocity gap: recorded velocity less that of models held softly to the recording."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.added import without_events
from bench.diagnose.chain import Grown
from bench.plant.model_file import StoredModel
from bench.plant.track import measured_velocity
from bench.plant.track_effects import Held, track_models
from bench.rig.rig import Rig
from bench.trace.trace import Trace

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Recorded:
    """A recording to hold models to.

    Attributes:
        name: of it.
        trace: the recording.
        effort: (n,) - N*m (N).
        judged: (n,) samples over which the gap is taken.
        events: whether the model's events happen in it.
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
        """A recording whose gap counts from a time on until another - s."""
        return cls(name, trace, rig.net_effort(trace)[0], (trace.time >= since) & (trace.time < until), events)

    def difference(self, simulated: Array) -> Array:
        """Simulated less measured velocity at the judged samples - rad/s (m/s)."""
        return (simulated - measured_velocity(self.trace))[self.judged]

    @property
    def varies(self) -> float:
        """RMS deviation of measured velocity from its mean: a simulation further off follows nothing - rad/s (m/s)."""
        return float(np.std(measured_velocity(self.trace)[self.judged]))

    def holding(self, stored: StoredModel, inertia: float) -> Held:
        """A model to be held to it by a cascade laid out for an inertia - kg*m**2 (kg)."""
        model = stored.model if self.events else without_events(stored.model)
        return Held(model, self.trace, self.effort, stored.misalignment, inertia)


class VelocityGaps:
    """Velocity gaps of models along recordings, each simulated once.

    Args:
        bandwidth: of the cascade that holds them - rad/s.
        inertia: that it is laid out for - kg*m**2 (kg).
    """

    def __init__(self, bandwidth: float, inertia: float) -> None:
        self.bandwidth, self.inertia = bandwidth, inertia
        self._known: dict[tuple[object, ...], float] = {}

    def simulate(self, pairs: Iterable[tuple[Grown, Recorded]]) -> None:
        """Simulate models along recordings side by side, so far as that is not done."""
        asked = {self._key(*pair): pair for pair in pairs}
        new = {key: pair for key, pair in asked.items() if key not in self._known}
        self._known |= dict.fromkeys(new, float("nan"))
        run = {key: pair for key, pair in new.items() if pair[0].model is not None}
        models = [grown.model for grown, _ in run.values()]
        found = self.of_models(models, [recorded for _, recorded in run.values()])
        self._known |= dict(zip(run, found, strict=True))

    def of(self, grown: Grown, recorded: Recorded) -> float:
        """RMS of measured less simulated velocity - rad/s (m/s); nan without a model, or where it diverged."""
        self.simulate([(grown, recorded)])
        return self._known[self._key(grown, recorded)]

    def of_models(self, models: Iterable[StoredModel | None], recordings: Iterable[Recorded]) -> list[float]:
        """Gaps of models along recordings, one each."""
        recordings = list(recordings)
        simulated = self.velocities([m for m in models if m is not None], recordings)
        return [
            float("nan") if velocity is None else float(np.sqrt(np.mean(recorded.difference(velocity) ** 2)))
            for velocity, recorded in zip(simulated, recordings, strict=True)
        ]

    def velocities(self, models: Iterable[StoredModel], recordings: Iterable[Recorded]) -> list[Array | None]:
        """Velocities of models along recordings, one each, (n,) - rad/s (m/s); None where one diverged."""
        held = [r.holding(model, self.inertia) for model, r in zip(models, recordings, strict=True)]
        return track_models(held, self.bandwidth)

    def _key(self, grown: Grown, recorded: Recorded) -> tuple[object, ...]:
        return (grown.rows, grown.fitted.hypothesis.effects, grown.beside, recorded.name)
