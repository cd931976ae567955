"""Motions of an axis from rich to poor: a mixed one as made for identification, and what else axes are recorded at."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bench.validation.independent.references import (
    Chirp,
    Motion,
    Multisine,
    Ramps,
    random_motion,
    run_up_and_down,
    slow_reversals,
    staircase,
)
from bench.validation.independent.rig import Axis


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
