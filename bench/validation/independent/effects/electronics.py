"""Effects of motor and drive, and faults of what is measured: of current, its filter and constant, of angle and speed.

The mechanics do not feel the faults, except through the drive, which regulates what its sensors read; a filter of the
recorded current is the recorder's alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from bench.validation.independent.effects.effect import Effect, Rows, about, phase
from bench.validation.independent.rig import Axis


@dataclass(frozen=True)
class CoggingTorque(Effect):
    """Resisting torque A*sin(n*q + phi); A amplitude - N*m, n harmonic."""

    on_linear_axis: ClassVar[bool] = False
    amplitude: float
    harmonic: float
    phase: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        harmonic = float(rng.choice([4, 6, 8, 9, 12, 14, 18, 20, 24]))
        return cls(about(severity, rng) * axis.torque_scale, harmonic, phase(rng))

    def resisting_torque(self, rows: Rows) -> np.ndarray:
        return self.amplitude * np.sin(self.harmonic * rows.position + self.phase)


@dataclass(frozen=True)
class TorqueRipple(Effect):
    """Motor torque kT*i*(1 + a*sin(n*q + phi)); a relative_amplitude, n harmonic."""

    on_linear_axis: ClassVar[bool] = False
    relative_amplitude: float
    harmonic: float
    phase: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        harmonic = float(rng.choice([2, 3, 4, 6, 8, 12, 18, 24]))
        return cls(min(0.28 * about(severity, rng), 0.5), harmonic, phase(rng))

    def torque_factor(self, rows: Rows) -> np.ndarray:
        return 1.0 + self.relative_amplitude * np.sin(self.harmonic * rows.position + self.phase)


@dataclass(frozen=True)
class TorqueConstantSaturation(Effect):
    """kT(i) = kT*(1 - d*(i/i_peak)**2); d drop_at_peak."""

    drop_at_peak: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        # torque must still rise with current at the peak, which d < 1/3 makes sure
        return cls(min(0.35 * about(severity, rng), 0.3))

    def torque_factor(self, rows: Rows) -> np.ndarray:
        return 1.0 - self.drop_at_peak * (rows.acting_current / rows.peak_current) ** 2


@dataclass(frozen=True)
class VoltageLimit(Effect):
    """L*di/dt = v - R*i - K_e*w with |v| <= voltage - V; the drive meets its demand as fast as that allows."""

    voltage: float

    @classmethod
    def possible(cls, axis: Axis) -> bool:
        return axis.back_emf_constant > 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        # motions reach 0.85 of top speed or more, which a weak limit must still cut off
        return cls(axis.back_emf_constant * axis.top_speed * (0.93 - 0.35 * min(about(severity, rng), 1.0)))

    def driven_current(self, rows: Rows, demand: np.ndarray, current: np.ndarray, step: float) -> np.ndarray:
        decay = -np.expm1(-rows.resistance / rows.inductance * step)
        emf = rows.back_emf_constant * rows.velocity
        needed = emf + rows.resistance * (current + (demand - current) / decay)
        settled = (np.clip(needed, -self.voltage, self.voltage) - emf) / rows.resistance
        return current + (settled - current) * decay


@dataclass(frozen=True)
class CurrentLoopLag(Effect):
    """Acting current follows the reported one: T*di/dt = reported - i; T time_constant - s."""

    never_beside: ClassVar[str] = "velocity_filter_lag"
    time_constant: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(8e-3 * about(severity, rng) * _slowness(axis))

    def acting_current(self, current: np.ndarray, memory: np.ndarray, step: float) -> np.ndarray:
        return current + (memory - current) * np.exp(-step / self.time_constant)


@dataclass(frozen=True)
class CurrentFilterLag(Effect):
    """Recorded current y follows the one that the drive reads: T*dy/dt = i - y; T time_constant - s."""

    time_constant: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(3e-3 * about(severity, rng))

    def recorded_current(self, current: np.ndarray, memory: np.ndarray, step: float) -> np.ndarray:
        return current + (memory - current) * np.exp(-step / self.time_constant)


@dataclass(frozen=True)
class CurrentGainAsymmetry(Effect):
    """One ampere read is 1 + d/2 amperes of positive and 1 - d/2 of negative current; d gain_difference."""

    gain_difference: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(float(rng.choice([-1.0, 1.0]) * min(0.08 * about(severity, rng), 0.1)))  # of two shunts of 5 %

    def true_current(self, rows: Rows, reading: np.ndarray) -> np.ndarray:
        return np.where(reading > 0.0, 1.0 + self.gain_difference / 2.0, 1.0 - self.gain_difference / 2.0) * reading


@dataclass(frozen=True)
class CurrentOffsetDrift(Effect):
    """The sensor reads rate*t too much, as torque; rate - N*m/s."""

    rate: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(float(rng.choice([-1.0, 1.0]) * about(severity, rng) * axis.torque_scale / duration))

    def true_current(self, rows: Rows, reading: np.ndarray) -> np.ndarray:
        return reading - self.rate * rows.time / rows.torque_constant


@dataclass(frozen=True)
class TorqueConstantDrift(Effect):
    """kT*(1 + rate*t); rate - 1/s."""

    rate: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(float(rng.choice([-1.0, 1.0]) * min(0.12 * about(severity, rng), 0.3) / duration))  # of ferrites

    def torque_factor(self, rows: Rows) -> np.ndarray | float:
        return 1.0 + self.rate * rows.time


@dataclass(frozen=True)
class VelocityFilterLag(Effect):
    """Reported speed v follows the sensed one: T*dv/dt = w - v; T time_constant - s."""

    time_constant: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(8e-3 * about(severity, rng) * _slowness(axis))

    def filtered(self, before: np.ndarray, after: np.ndarray, memory: np.ndarray, step: float) -> np.ndarray:
        # exact for a sensed speed that changes linearly within the step: v lags it by T*(1 - exp(-t/T)) of its slope
        slope = (after - before) / step
        decay = np.exp(-step / self.time_constant)
        return after - slope * self.time_constant * (1.0 - decay) + (memory - before) * decay


@dataclass(frozen=True)
class EncoderEccentricity(Effect):
    """Measured angle q + e*sin(q + phi), measured speed its derivative; e amplitude - rad."""

    on_linear_axis: ClassVar[bool] = False
    amplitude: float
    phase: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(0.035 * about(severity, rng), phase(rng))

    def measured(self, position: np.ndarray, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        angle = position + self.phase
        return position + self.amplitude * np.sin(angle), speed * (1.0 + self.amplitude * np.cos(angle))


def _slowness(axis: Axis) -> float:
    """A drive of 150 rad/s bears lags of some milliseconds; a faster one shorter ones, or it would not be stable."""
    return min(150.0 * axis.inertia / axis.velocity_gain, 1.5)
