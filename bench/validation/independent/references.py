"""Motions that a drive is commanded to make: position, speed and acceleration in closed form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bench.validation.independent.rig import Axis


class Phase(Protocol):
    """A part of a motion: its duration - s -, and the distance gone in it - rad."""

    duration: float
    distance: float

    def at(self, time: np.ndarray) -> tuple[np.ndarray, ...]:
        """Position, speed, acceleration at times within the duration - rad, rad/s, rad/s**2."""
        ...


class Ramps:
    """Speed through given points, linear between them, averaged over `jerk_time`: acceleration has no jumps.

    A drive's own generator limits jerk too; and a jump of current between two samples could not be recorded.

    Args:
        points: (time - s, speed - rad/s), the first at time 0, at rest at both ends.
        jerk_time: in which acceleration goes from one value to the next - s.
    """

    def __init__(self, points: Sequence[tuple[float, float]], jerk_time: float) -> None:
        self._time, self._speed = (np.array(column, dtype=float) for column in zip(*points, strict=True))
        length, rise = np.diff(self._time), np.diff(self._speed)
        gone = self._speed[:-1] * length + rise * length / 2.0
        self._gone = np.concatenate([[0.0], np.cumsum(gone)])
        area = self._gone[:-1] * length + self._speed[:-1] * length**2 / 2.0 + rise * length**2 / 6.0
        self._area = np.concatenate([[0.0], np.cumsum(area)])
        self._jerk_time = jerk_time
        self.duration, self.distance = float(self._time[-1]) + jerk_time, float(self._gone[-1])

    def _sharp(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Integral of position, position, and speed before averaging."""
        inside = np.clip(time, 0.0, self._time[-1])
        piece = np.clip(np.searchsorted(self._time, inside, side="right") - 1, 0, self._time.size - 2)
        length, rise = np.diff(self._time)[piece], np.diff(self._speed)[piece]
        x, speed, gone = inside - self._time[piece], self._speed[piece], self._gone[piece]
        slope = rise / length
        area = self._area[piece] + gone * x + speed * x**2 / 2.0 + slope * x**3 / 6.0
        beyond = np.maximum(time - self._time[-1], 0.0)
        return area + beyond * self.distance, gone + speed * x + slope * x**2 / 2.0, speed + slope * x

    def at(self, time: np.ndarray) -> tuple[np.ndarray, ...]:
        """As every phase of a motion has it."""
        ends = zip(self._sharp(time), self._sharp(time - self._jerk_time), strict=True)
        return tuple((now - then) / self._jerk_time for now, then in ends)


@dataclass
class Multisine:
    """Position sum of sines, faded in and out by sin(pi*t/duration)**2 so that it starts and ends at rest.

    Attributes:
        speeds, frequencies, phases: amplitude of each sine's speed - rad/s, its frequency - Hz, its phase - rad.
    """

    duration: float
    speeds: np.ndarray
    frequencies: np.ndarray
    phases: np.ndarray
    distance: float = 0.0

    def at(self, time: np.ndarray) -> tuple[np.ndarray, ...]:
        """As every phase of a motion has it."""
        omega = 2.0 * np.pi * self.frequencies
        amplitudes, angle = self.speeds / omega, np.outer(time, omega) + self.phases
        # summed by rows: a matrix product rounds differently with the number of times asked for
        x = np.sum(np.sin(angle) * amplitudes, axis=1)
        dx = np.sum(np.cos(angle) * amplitudes * omega, axis=1)
        ddx = -np.sum(np.sin(angle) * amplitudes * omega**2, axis=1)
        return _faded(time, self.duration, x, dx, ddx)


@dataclass
class Chirp:
    """Speed amplitude*sin of a phase that sweeps its frequency linearly, faded like the multisine's position.

    Attributes:
        amplitude: of the position - rad.
        first, last: frequencies - Hz.
    """

    duration: float
    amplitude: float
    first: float
    last: float
    distance: float = 0.0

    def at(self, time: np.ndarray) -> tuple[np.ndarray, ...]:
        """As every phase of a motion has it."""
        sweep = (self.last - self.first) / self.duration
        angle = 2.0 * np.pi * (self.first * time + 0.5 * sweep * time**2)
        omega, slope = 2.0 * np.pi * (self.first + sweep * time), 2.0 * np.pi * sweep
        x, dx = self.amplitude * np.sin(angle), self.amplitude * omega * np.cos(angle)
        return _faded(time, self.duration, x, dx, self.amplitude * (slope * np.cos(angle) - omega**2 * np.sin(angle)))


def _faded(time: np.ndarray, duration: float, x: np.ndarray, dx: np.ndarray, ddx: np.ndarray) -> tuple[np.ndarray, ...]:
    """Position, speed, acceleration of x*sin(pi*t/duration)**2."""
    turn = 2.0 * np.pi / duration
    f, df, ddf = 0.5 - 0.5 * np.cos(turn * time), 0.5 * turn * np.sin(turn * time), 0.5 * turn**2 * np.cos(turn * time)
    return f * x, df * x + f * dx, ddf * x + 2.0 * df * dx + f * ddx


@dataclass(frozen=True)
class Motion:
    """Phases one after the other; at rest where they end afterwards."""

    phases: tuple[Phase, ...]

    @property
    def duration(self) -> float:
        """Of all phases - s."""
        return sum(phase.duration for phase in self.phases)

    def at(self, time: np.ndarray) -> np.ndarray:
        """Position, speed and acceleration reference - rad, rad/s, rad/s**2 - (3, n)."""
        reference = np.zeros((3, time.size))
        start = origin = 0.0
        for phase in self.phases:
            now = (time >= start) & (time < start + phase.duration)
            if now.any():
                reference[:, now] = phase.at(time[now] - start)
            reference[0, now] += origin
            start, origin = start + phase.duration, origin + phase.distance
        reference[0, time >= start] = origin
        return reference


def run_up_and_down(speed: float, acceleration: float, dwell: float, repeats: int, jerk_time: float) -> Ramps:
    """Fast trapezoids to both sides, as the lab's accelerate and decelerate run."""
    return _through([speed, -speed] * repeats + [0.0], acceleration, dwell, jerk_time)


def staircase(top: float, steps: int, acceleration: float, dwell: float, jerk_time: float) -> Ramps:
    """Speeds in geometric steps up to `top`, held, then the same in the other direction."""
    levels = top * np.geomspace(0.02, 1.0, steps)
    return _through([*levels, 0.0, *-levels, 0.0], acceleration, dwell, jerk_time)


def _through(speeds: Sequence[float], acceleration: float, dwell: float, jerk_time: float) -> Ramps:
    points = [(0.0, 0.0)]
    for speed in speeds:
        time, now = points[-1]
        time += abs(speed - now) / acceleration
        points += [(time, float(speed)), (time + dwell, float(speed))]
    return Ramps(points, jerk_time)


def slow_reversals(speeds: Sequence[float], half_period: float, jerk_time: float) -> Ramps:
    """Triangles of speed through zero, one for each given amplitude."""
    points = [(0.0, 0.0)]
    for speed in speeds:
        time = points[-1][0]
        points += [(time + half_period * share, speed * sign) for share, sign in ((0.5, 1), (1.5, -1), (2.0, 0))]
    return Ramps(points, jerk_time)


def multisine(speed: float, acceleration: float, duration: float, rng: np.random.Generator) -> Multisine:
    """Sines of 2 to 18 Hz on a geometric grid, random phases; peaks about `speed` - rad/s - and `acceleration`."""
    frequencies = np.geomspace(2.0, 18.0, 9) * rng.uniform(0.95, 1.05, 9)
    # nine sines rarely peak above 2.5 times their RMS
    peak_of_unit = 2.5 * np.sqrt([9.0 / 2.0, np.sum((2.0 * np.pi * frequencies) ** 2) / 2.0])
    speeds = np.full(9, min(speed / peak_of_unit[0], acceleration / peak_of_unit[1]))
    return Multisine(duration, speeds, frequencies, rng.uniform(-np.pi, np.pi, 9))


def _jerk_time(rng: np.random.Generator) -> float:
    return float(np.exp(rng.uniform(np.log(0.01), np.log(0.06))))


def random_motion(axis: Axis, rng: np.random.Generator, duration: float = 8.0) -> Motion:
    """A mixed recording in random order: fast runs both ways, staircase, slow reversals, and a multisine or a chirp."""
    top = axis.top_speed * rng.uniform(0.85, 1.0)
    peak = axis.peak_torque / axis.inertia
    acceleration = min(rng.uniform(0.45, 0.75) * peak, top / 0.03)
    gentle = acceleration * rng.uniform(0.4, 0.9)
    jerk_time = _jerk_time(rng)
    ramp = top / acceleration + jerk_time
    repeats = 2 if 12 * ramp < 0.3 * duration else 1
    run_dwell = max((0.3 * duration - 4 * repeats * ramp) / (2 * repeats + 1), 0.006 * duration)
    stair_top = top * rng.uniform(0.7, 1.0)
    stair_dwell = max((0.3 * duration - 4 * stair_top / gentle) / 18, 0.006 * duration)
    slow = axis.top_speed * rng.uniform(0.02, 0.08, 4) * rng.choice([-1, 1])
    phases: list[Phase] = [
        run_up_and_down(top, acceleration, run_dwell, repeats, jerk_time),
        staircase(stair_top, 8, gentle, stair_dwell, jerk_time),
        slow_reversals(slow, 0.2 * duration / 8, jerk_time),
    ]
    if rng.random() < 0.6:
        phases.append(multisine(0.3 * top, 0.4 * peak, 0.2 * duration, rng))
    else:
        highest = rng.uniform(8.0, 16.0)
        phases.append(Chirp(0.2 * duration, 0.3 * peak / (2.0 * np.pi * highest) ** 2, 1.0, highest))
    order = rng.permutation(len(phases))
    rest = Ramps([(0.0, 0.0), (float(rng.uniform(0.02, 0.1)), 0.0)], jerk_time)
    return Motion((rest, *(phases[i] for i in order), rest))


def _gentle(axis: Axis, rng: np.random.Generator) -> float:
    """An acceleration well within what the motor can do - rad/s**2."""
    return float(rng.uniform(0.2, 0.6)) * axis.peak_torque / axis.inertia


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
