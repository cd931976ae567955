"""Record axes: reference, drive, plant and sensors in a closed loop, many side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from bench.trace.trace import Trace
from bench.validation.independent.effects import Effect
from bench.validation.independent.plant import Plant
from bench.validation.independent.references import Motion
from bench.validation.independent.rig import Axis, stack
from bench.validation.independent.sensors import NoiseStream, Sensors, rounded


class Drive:
    """torque = K_v*e_v + K_i*integral(e_v dt) + J_ff*alpha_ref, e_v = w_ref + K_p*(q_ref - q) - w.

    Current is limited to its peak, the integrator held while limited; one command each control period.
    """

    def __init__(self, axes: Sequence[Axis], control_period: float) -> None:
        self._axes, self._period, self._integral = stack(axes), control_period, np.zeros(len(axes))

    def current(self, reference: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Current demand - A - from q_ref, w_ref, alpha_ref (3, n) and measurements - (n,) each."""
        (q, w, alpha), axes = reference, self._axes
        error = w + axes.position_gain * (q - position) - velocity
        torque = axes.velocity_gain * error + axes.integral_gain * self._integral + axes.inertia_feedforward * alpha
        demand = torque / axes.torque_constant
        free = np.abs(demand) < axes.peak_current
        self._integral += self._period * error * free
        return np.where(free, demand, np.sign(demand) * axes.peak_current)


#: Its share of the current is 2e-5 of its peak at most, with any effect of the catalogue but contacts and limits,
#: after which runs part at any step (`tests/independent/test_step.py`) - s.
LONGEST_STEP = 62.5e-6
SIDE_BY_SIDE = 400
BLOCK = 512


@dataclass(frozen=True)
class Recorded:
    """A recording with its truth.

    Attributes:
        trace: what the sensors reported.
        true: at the same times, without sensors: position, velocity, motor_torque (of the control period before) - and
            without noise as the electronics would have seen it: measured_velocity, current - SI - (n,) each.
    """

    trace: Trace
    axis: Axis
    motion: Motion
    effects: tuple[Effect, ...]
    sensors: Sensors
    true: dict[str, np.ndarray]


def simulate(
    axes: Sequence[Axis],
    motions: Sequence[Motion],
    effects: Sequence[Sequence[Effect]],
    sensors: Sequence[Sensors],
    seed: int = 0,
    *,
    numbers: Sequence[int] | None = None,
    longest_step: float = LONGEST_STEP,
) -> list[Recorded]:
    """One recording an axis, in the order given.

    An axis' noise depends on `seed` and its number alone, which is its place in the list if not given: with a number of
    its own, it can be simulated again without the others.
    """
    numbers = range(len(axes)) if numbers is None else numbers
    runs = [_Run(*one) for one in zip(numbers, axes, motions, map(tuple, effects), sensors, strict=True)]
    recordings: dict[int, Recorded] = {}
    for period in sorted({axis.control_period for axis in axes}):
        same = [k for k, axis in enumerate(axes) if axis.control_period == period]
        same.sort(key=lambda k: motions[k].duration)
        for first in range(0, len(same), SIDE_BY_SIDE):
            places = same[first : first + SIDE_BY_SIDE]
            beside = _recorded([runs[k] for k in places], period, seed, longest_step)
            recordings |= dict(zip(places, beside, strict=True))
    return [recordings[k] for k in range(len(axes))]


@dataclass(frozen=True)
class _Run:
    """What is recorded of one axis, and its number, which its noise depends on."""

    number: int
    axis: Axis
    motion: Motion
    effects: tuple[Effect, ...]
    sensors: Sensors

    @property
    def decimation(self) -> int:
        """Control periods a sample."""
        ratio = self.sensors.sample_period / self.axis.control_period
        if abs(ratio - round(ratio)) > 1e-6 or ratio < 1.0 - 1e-6:
            period = f"sample period {self.sensors.sample_period} s"
            raise ValueError(f"{self.axis.name}: {period} is no multiple of {self.axis.control_period} s")
        return round(ratio)

    def recorded(self, signals: np.ndarray, seed: int) -> Recorded:
        """What its sensors report of signals (7, samples)."""
        axis, sensors = self.axis, self.sensors
        count = int(self.motion.duration / sensors.sample_period + 1e-9) + 1
        time = sensors.sample_period * np.arange(count, dtype=float)
        position, velocity, torque, measured, clean, current, noise = signals[:, :count]
        hiss = NoiseStream(sensors.current, sensors.sample_period, np.random.default_rng([seed, self.number, 1]))
        reference = self.motion.at(time)
        reported = {
            "position": measured,
            "velocity": rounded(clean + noise, sensors.velocity.resolution),
            "current": rounded(current + hiss.at(time), sensors.current.resolution),
            "position_reference": reference[0],
            "velocity_reference": reference[1],
        }
        if not sensors.position_recorded:
            del reported["position"], reported["position_reference"]
        length = "m" if axis.linear else "rad"
        units = {name: "A" if name == "current" else length + "/s" * name.startswith("velocity") for name in reported}
        true = {
            "position": position,
            "velocity": velocity,
            "motor_torque": torque,
            "measured_velocity": clean,
            "current": current,
        }
        trace = Trace(time, reported, units, f"independent {axis.name}")
        return Recorded(trace, axis, self.motion, self.effects, sensors, true)


def _recorded(runs: Sequence[_Run], period: float, seed: int, longest_step: float) -> list[Recorded]:
    """Axes of one control period - s - simulated together."""
    decimations = [run.decimation for run in runs]
    kept: list[list[np.ndarray]] = [[] for _ in runs]
    for first, block in _blocks(runs, period, seed, longest_step):
        for k, decimation in enumerate(decimations):
            kept[k].append(block[-first % decimation :: decimation, :, k])
    return [run.recorded(np.concatenate(rows).T, seed) for run, rows in zip(runs, kept, strict=True)]


def _blocks(runs: Sequence[_Run], period: float, seed: int, longest_step: float) -> Iterator[tuple[int, np.ndarray]]:
    """First tick, and signals (ticks, 7, axes): the six below and the noise of the speed."""
    substeps = ceil(period / longest_step - 1e-9)
    axes, sensors = [run.axis for run in runs], [run.sensors for run in runs]
    plant, drive = Plant(axes, [run.effects for run in runs]), Drive(axes, period)
    resolution = np.array([one.encoder_resolution for one in sensors])
    rounding = np.array([one.velocity.resolution if one.velocity_noise_fed_back else 0.0 for one in sensors])
    streams = [NoiseStream(run.sensors.velocity, period, np.random.default_rng([seed, run.number, 0])) for run in runs]
    fed_back = np.array([one.velocity_noise_fed_back for one in sensors], dtype=float)
    filtered = np.array([one.velocity_filter_fed_back for one in sensors])
    fresh = np.array([one.current_age for one in sensors]) == 0
    ticks = ceil(max(run.motion.duration for run in runs) / period) + 1
    for first in range(0, ticks, BLOCK):
        time = period * np.arange(first, min(first + BLOCK, ticks))
        reference = np.stack([run.motion.at(time) for run in runs], axis=-1)
        noise = np.stack([stream.at(time) for stream in streams], axis=-1)
        block = np.empty((time.size, 7, len(runs)))
        for tick, row in enumerate(block):
            position = rounded(plant.measured_position, resolution)
            seen = np.where(filtered, plant.measured_velocity, plant.sensed_velocity)
            velocity = rounded(seen + fed_back * noise[tick], rounding)
            demand = drive.current(reference[:, tick], position, velocity)
            row[0], row[1], row[2] = plant.position, plant.velocity, plant.motor_torque
            row[3], row[4], row[5], row[6] = position, plant.measured_velocity, plant.recorded_current, noise[tick]
            for substep in range(substeps):
                plant.advance(demand, period / substeps)
                if substep == 0:
                    row[5] = np.where(fresh, plant.recorded_current, row[5])
        if not np.isfinite(block).all():
            lost = [axes[int(k)].name for k in np.flatnonzero(~np.isfinite(block).all(axis=(0, 1)))]
            raise FloatingPointError(f"diverged: {', '.join(lost)}")
        yield first, block
