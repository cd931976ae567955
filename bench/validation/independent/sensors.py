"""What recording electronics add to the truth: noise, quantisation, mains interference, sampling."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.validation.independent.rig import Axis


@dataclass(frozen=True)
class Noise:
    """Additive noise of one signal, then rounding. All zero: none.

    Attributes:
        white: standard deviation - unit of the signal.
        coloured, correlation_time: standard deviation of a first-order Markov process and its time - unit, s.
        hum, hum_frequency, hum_phase: amplitude of mains pick-up - unit, Hz, rad.
        resolution: the signal is rounded to multiples of it - unit.
    """

    white: float = 0.0
    coloured: float = 0.0
    correlation_time: float = 5e-3
    hum: float = 0.0
    hum_frequency: float = 50.0
    hum_phase: float = 0.0
    resolution: float = 0.0

    @property
    def kind(self) -> str:
        """The kind of noise in addition to white, if any."""
        return "hum" if self.hum else "coarse" if self.resolution else "coloured" if self.coloured else "white"


class NoiseStream:
    """Noise of one signal, drawn block by block at a constant period."""

    def __init__(self, noise: Noise, period: float, rng: np.random.Generator) -> None:
        # one source each, so that the lengths of blocks do not matter
        self._noise, (self._white, self._drive) = noise, rng.spawn(2)
        self._pole = float(np.exp(-period / noise.correlation_time))
        self._state = np.array([self._pole * self._drive.standard_normal()])

    def at(self, time: np.ndarray) -> np.ndarray:
        """Noise at the next times, which follow the block before."""
        noise, total = self._noise, np.zeros(time.size)
        if noise.white:
            total += noise.white * self._white.standard_normal(time.size)
        if noise.coloured:
            from scipy.signal import lfilter  # 0.6 s, which only coloured noise has to pay

            drive = np.sqrt(1.0 - self._pole**2) * self._drive.standard_normal(time.size)
            markov, self._state = lfilter([1.0], [1.0, -self._pole], drive, zi=self._state)
            total += noise.coloured * markov
        if noise.hum:
            total += noise.hum * np.sin(2.0 * np.pi * noise.hum_frequency * time + noise.hum_phase)
        return total


def rounded(values: np.ndarray, resolution: np.ndarray | float) -> np.ndarray:
    """Values at multiples of a resolution, which may be 0 for none."""
    scale = np.where(np.asarray(resolution) > 0.0, resolution, 1.0)
    return np.where(np.asarray(resolution) > 0.0, np.round(values / scale) * scale, values)


@dataclass(frozen=True)
class Sensors:
    """How an axis is recorded.

    Attributes:
        sample_period: a multiple of the control period - s.
        encoder_resolution: angle of one count, felt by drive and recording; 0 ideal - rad.
        velocity, current: noise of the reported speed and current.
        position_recorded: whether the recording holds the position and its reference.
        velocity_noise_fed_back: whether the drive sees the noise of the speed too, or only the recording does.
        velocity_filter_fed_back: the same of a filter on the speed (`VelocityFilterLag`).
        current_age: 0, the current just after the control tick that a sample falls on; 1, just before it.
    """

    sample_period: float = 1e-3
    encoder_resolution: float = 2.0 * np.pi / 2**18
    velocity: Noise = Noise()
    current: Noise = Noise()
    position_recorded: bool = True
    velocity_noise_fed_back: bool = False
    velocity_filter_fed_back: bool = False
    current_age: int = 0

    def __post_init__(self) -> None:
        if self.current_age not in (0, 1):
            raise ValueError("current_age is 0 or 1 control periods")


def random_sensors(axis: Axis, rng: np.random.Generator, level: float = 1.0) -> Sensors:
    """Electronics drawn at random: white, coloured, humming or coarse, 0.5 to 4 ms; `level` scales noise."""
    speed_noise = level * axis.top_speed * np.exp(rng.uniform(np.log(5e-5), np.log(3e-4)))
    current_noise = level * axis.peak_current * np.exp(rng.uniform(np.log(1e-3), np.log(4e-3)))
    counts = float(2 ** rng.integers(14, 21))
    return Sensors(
        sample_period=float(rng.choice([0.5e-3, 1e-3, 2e-3, 4e-3], p=[0.3, 0.4, 0.2, 0.1])),
        encoder_resolution=(1e-6 if axis.linear else 2.0 * np.pi / counts),
        velocity=_random_noise(speed_noise, rng),
        current=_random_noise(current_noise, rng),
        position_recorded=bool(rng.random() < 0.75),
        velocity_noise_fed_back=bool(rng.random() < 0.3),
        current_age=int(rng.integers(0, 2)),
        velocity_filter_fed_back=bool(rng.random() < 0.5),
    )


def _random_noise(sigma: float, rng: np.random.Generator) -> Noise:
    kind = rng.choice(["white", "coloured", "hum", "coarse"])
    return Noise(
        white=sigma * (0.5 if kind == "coloured" else 1.0),
        coloured=sigma if kind == "coloured" else 0.0,
        correlation_time=float(rng.uniform(0.5e-3, 4e-3)),
        hum=sigma if kind == "hum" else 0.0,
        hum_phase=float(rng.uniform(-np.pi, np.pi)),
        resolution=2.0 * sigma if kind == "coarse" else 0.0,
    )
