"""Effects of the sensor: the mechanics do not feel them, except through the drive that believes the sensor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from bench.validation.independent.effects.effect import Effect, about, phase
from bench.validation.independent.effects.motor import _slowness
from bench.validation.independent.rig import Axis

if TYPE_CHECKING:
    pass


@dataclass(frozen=True)
class VelocityFilterLag(Effect):
    """Reported speed v follows the sensed one: T*dv/dt = w - v; T time_constant - s."""

    name: ClassVar[str] = "velocity_filter_lag"
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

    name: ClassVar[str] = "encoder_eccentricity"
    on_linear_axis: ClassVar[bool] = False
    amplitude: float
    phase: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(0.035 * about(severity, rng), phase(rng))

    def measured(self, position: np.ndarray, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        angle = position + self.phase
        return position + self.amplitude * np.sin(angle), speed * (1.0 + self.amplitude * np.cos(angle))
