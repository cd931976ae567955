"""Recordings of axes that lack nothing, over motions from rich to poor, by the independent integrator."""

from __future__ import annotations

import hashlib
import pickle
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.trace.trace import Trace
from bench.validate.independent import Axis, Motion, random_motion, random_rig, random_sensors, simulate
from bench.validate.independent.references import Chirp, Multisine, Ramps, run_up_and_down, slow_reversals, staircase
from tests.kept import INTEGRATOR

#: Half of the shortest control period, as the blind set has it - s.
LONGEST_STEP = 31.25e-6


@dataclass(frozen=True)
class Known:
    """An axis and a recording of it, as plain as a file holds it."""

    axis: Axis
    signals: Mapping[str, np.ndarray]
    units: Mapping[str, str]

    @property
    def trace(self) -> Trace:
        """The recording."""
        signals = {name: values for name, values in self.signals.items() if name != "time"}
        return Trace(self.signals["time"], signals, self.units, self.axis.name)


def recordings(count: int, seed: int, duration: float) -> dict[str, list[Known]]:
    """`count` recordings of each motion; kept on disk for the next run, until integrator or draw change.

    Args:
        count: of each motion.
        seed: of everything random.
        duration: of one, about - s.
    """
    digest = hashlib.sha256()
    for path in (*INTEGRATOR, Path(__file__)):
        digest.update(path.read_bytes())
    place = Path(tempfile.gettempdir()) / f"coverage-{digest.hexdigest()[:10]}" / f"{seed}-{count}-{duration:g}s.pickle"
    if not place.exists():
        place.parent.mkdir(parents=True, exist_ok=True)
        made = _recorded(count, seed, duration)
        partial = place.with_suffix(".part")
        partial.write_bytes(pickle.dumps(made))
        partial.rename(place)  # last, since it says that all is there
    return pickle.loads(place.read_bytes())


def _recorded(count: int, seed: int, duration: float) -> dict[str, list[Known]]:
    axes, motions, sensors, names = [], [], [], []
    for kind, (name, make) in enumerate(MOTIONS.items()):
        for place in range(count):
            rng = np.random.default_rng([seed, kind, place])
            axis = random_rig(rng, f"{name} {place}")
            axes.append(axis)
            motions.append(make(axis, rng, duration))
            sensors.append(random_sensors(axis, rng))
            names.append(name)
    made = simulate(axes, motions, [()] * len(axes), sensors, seed, longest_step=LONGEST_STEP)
    known: dict[str, list[Known]] = {name: [] for name in MOTIONS}
    for name, run in zip(names, made, strict=True):
        signals = {"time": run.trace.time, **run.trace.signals}
        known[name].append(Known(run.axis, signals, dict(run.trace.units)))
    return known


def _gentle(axis: Axis, rng: np.random.Generator) -> float:
    """An acceleration well within what the motor can do - rad/s**2."""
    return float(rng.uniform(0.2, 0.6)) * axis.peak_torque / axis.inertia


def _jerk_time(rng: np.random.Generator) -> float:
    return float(np.exp(rng.uniform(np.log(0.01), np.log(0.06))))


def _up_and_down(axis: Axis, rng: np.random.Generator, duration: float) -> Motion:
    top, acceleration, jerk = axis.top_speed * rng.uniform(0.4, 1.0), _gentle(axis, rng), _jerk_time(rng)
    ramps = 12.0 * (top / acceleration + jerk)
    return Motion((run_up_and_down(top, acceleration, max(duration - ramps, 0.2 * duration) / 6.0, 3, jerk),))


def _two_trapezoids(axis: Axis, rng: np.random.Generator, duration: float) -> Motion:
    top, acceleration, jerk = axis.top_speed * rng.uniform(0.4, 1.0), _gentle(axis, rng), _jerk_time(rng)
    return Motion((run_up_and_down(top, acceleration, 0.4 * duration, 1, jerk),))


def _one_trapezoid(axis: Axis, rng: np.random.Generator, duration: float) -> Motion:
    top, side = axis.top_speed * rng.uniform(0.4, 1.0), float(rng.choice([-1.0, 1.0]))
    rise = top / _gentle(axis, rng)
    points = [(0.0, 0.0), (0.1, 0.0), (0.1 + rise, side * top), (0.8 * duration, side * top)]
    return Motion((Ramps([*points, (0.8 * duration + rise, 0.0), (duration + rise, 0.0)], _jerk_time(rng)),))


def _very_slow(axis: Axis, rng: np.random.Generator, duration: float) -> Motion:
    top = axis.top_speed * float(np.exp(rng.uniform(np.log(0.01), np.log(0.05))))
    steps = staircase(top, 4, top / 0.05, duration / 10.0, _jerk_time(rng))
    return Motion((steps, slow_reversals((top * rng.uniform(0.5, 1.0, 2)).tolist(), duration / 10.0, _jerk_time(rng))))


def _one_sine(axis: Axis, rng: np.random.Generator, duration: float) -> Motion:
    frequency = float(np.exp(rng.uniform(np.log(0.5), np.log(6.0))))
    speed = min(0.8 * axis.top_speed, _gentle(axis, rng) / (2.0 * np.pi * frequency))
    return Motion((Multisine(duration, np.array([speed]), np.array([frequency]), rng.uniform(-np.pi, np.pi, 1)),))


def _chirp(axis: Axis, rng: np.random.Generator, duration: float) -> Motion:
    highest = float(rng.uniform(4.0, 16.0))
    amplitude = min(_gentle(axis, rng) / (2.0 * np.pi * highest), 0.8 * axis.top_speed) / (2.0 * np.pi * highest)
    return Motion((Chirp(duration, amplitude, 0.5, highest),))


#: Of each kind of motion, how one is drawn for an axis to last about so long - s.
MOTIONS: dict[str, Callable[[Axis, np.random.Generator, float], Motion]] = {
    "mixed": random_motion,
    "up and down": _up_and_down,
    "two trapezoids": _two_trapezoids,
    "one trapezoid, one way": _one_trapezoid,
    "very slow": _very_slow,
    "one sine": _one_sine,
    "chirp": _chirp,
}
