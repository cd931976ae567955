"""Faults of the current's measurement. The drive regulates what its sensor reads; a filter is the recorder's alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from bench.validation.independent.effects.effect import Effect, about
from bench.validation.independent.rig import Axis

if TYPE_CHECKING:
    from bench.validation.independent.plant import Rows


@dataclass(frozen=True)
class CurrentFilterLag(Effect):
    """Recorded current y follows the one that the drive reads: T*dy/dt = i - y; T time_constant - s."""

    name: ClassVar[str] = "current_filter_lag"
    time_constant: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(3e-3 * about(severity, rng))

    def recorded_current(self, current: np.ndarray, memory: np.ndarray, step: float) -> np.ndarray:
        return current + (memory - current) * np.exp(-step / self.time_constant)


@dataclass(frozen=True)
class CurrentGainAsymmetry(Effect):
    """One ampere read is 1 + d/2 amperes of positive and 1 - d/2 of negative current; d gain_difference."""

    name: ClassVar[str] = "current_gain_asymmetry"
    gain_difference: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(float(rng.choice([-1.0, 1.0]) * 0.08 * about(severity, rng)))

    def true_current(self, rows: Rows, reading: np.ndarray) -> np.ndarray:
        return np.where(reading > 0.0, 1.0 + self.gain_difference / 2.0, 1.0 - self.gain_difference / 2.0) * reading


@dataclass(frozen=True)
class CurrentOffsetDrift(Effect):
    """The sensor reads rate*t too much, as torque; rate - N*m/s."""

    name: ClassVar[str] = "current_offset_drift"
    rate: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(float(rng.choice([-1.0, 1.0]) * about(severity, rng) * axis.torque_scale / duration))

    def true_current(self, rows: Rows, reading: np.ndarray) -> np.ndarray:
        return reading - self.rate * rows.time / rows.torque_constant


@dataclass(frozen=True)
class TorqueConstantDrift(Effect):
    """kT*(1 + rate*t); rate - 1/s."""

    name: ClassVar[str] = "torque_constant_drift"
    rate: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(float(rng.choice([-1.0, 1.0]) * 0.12 * about(severity, rng) / duration))

    def torque_factor(self, rows: Rows) -> np.ndarray | float:
        return 1.0 + self.rate * rows.time
