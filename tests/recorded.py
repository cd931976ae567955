"""Two axes of the independent integrator that many tests hide effects in, recorded side by side and kept on disk."""

from __future__ import annotations

import pickle
import tomllib
from collections.abc import Mapping
from typing import NamedTuple, TypeVar

from bench.rig.rig import Rig
from bench.trace.trace import Trace
from bench.validation.independent.effects import Effect
from bench.validation.independent.references import Motion
from bench.validation.independent.rig import Axis, rig_text
from bench.validation.independent.sensors import Noise, Sensors
from bench.validation.independent.simulate import simulate
from tests.kept import kept

K = TypeVar("K")
#: Of the integrator, whose error is of second order (`tests/independent/test_step.py`): it leaves 8e-5 of the peak
#: current, a tenth of the noise - s.
STEP = 125e-6


class Recorder(NamedTuple):
    """An axis with its sensors."""

    axis: Axis
    sensors: Sensors

    @property
    def rig(self) -> Rig:
        """What a user knows of the axis."""
        return Rig.of(tomllib.loads(rig_text(self.axis)), self.axis.name)

    def record(
        self,
        effects: Mapping[K, tuple[Effect, ...]],
        motions: Motion | Mapping[K, Motion],
        seed: int,
        numbers: Mapping[K, int] | None = None,
    ) -> dict[K, Trace]:
        """A recording of each case, by its name, made once.

        Args:
            effects: of each case.
            motions: one for all, or one for each.
            seed, numbers: noise depends on both; a number is the place of the case if not given.
        """
        each = [motions if isinstance(motions, Motion) else motions[name] for name in effects]
        drawn = [place if numbers is None else numbers[name] for place, name in enumerate(effects)]
        count = len(each)
        together = [self.axis] * count, each, list(effects.values()), [self.sensors] * count, seed
        runs = kept(
            lambda: [run.trace for run in simulate(*together, numbers=drawn, longest_step=STEP)],
            __file__,
            pickle.dumps((together, drawn)),
        )
        return dict(zip(effects, runs, strict=True))


PLAIN = Recorder(
    Axis("axis", 1.5e-3, 8e-4, 0.08, 5e-4, 0.7, 6.0, velocity_gain=0.15, integral_gain=2.0, inertia_feedforward=1.4e-3),
    Sensors(velocity=Noise(white=0.03), current=Noise(white=8e-3), encoder_resolution=2e-5),
)
QUIET = Recorder(
    Axis("axis", 1e-3, 6e-4, 0.08, 3.5e-4, 0.8, 5.0, velocity_gain=0.12, integral_gain=2.0),
    Sensors(velocity=Noise(white=0.01), current=Noise(white=5e-3)),
)
