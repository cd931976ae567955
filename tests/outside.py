"""Physics that no catalogue lists: a diagnosis must leave it unnamed, and say where it sits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from bench.validation.independent.effects import Effect, Rows, about, phase
from bench.validation.independent.rig import Axis


@dataclass(frozen=True)
class SlowMemoryFriction(Effect):
    """Level K_0*(1 + A*m) with T*dm/dt = |w|/w_0 - m: friction remembers how fast the axis ran.

    A relative_amplitude, T time_constant - s, w_0 speed - rad/s.
    """

    name: ClassVar[str] = "slow_memory_friction"
    relative_amplitude: float
    time_constant: float
    speed: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(4.0 * about(severity, rng), duration * rng.uniform(0.06, 0.15), 0.5 * axis.top_speed)

    def friction_factor(self, rows: Rows) -> np.ndarray:
        return 1.0 + self.relative_amplitude * rows.memory

    def remember(self, rows: Rows, memory: np.ndarray, step: float) -> np.ndarray:
        tends = np.abs(rows.velocity) / self.speed
        return tends + (memory - tends) * np.exp(-step / self.time_constant)


@dataclass(frozen=True)
class PositionNotch(Effect):
    """Resisting torque A*exp(-(d/s)**2) where d is the angle from the notch within the turn; A - N*m, s width - rad."""

    name: ClassVar[str] = "position_notch"
    on_linear_axis: ClassVar[bool] = False
    amplitude: float
    angle: float
    width: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(2.5 * about(severity, rng) * axis.torque_scale, phase(rng), rng.uniform(0.1, 0.3))

    def resisting_torque(self, rows: Rows) -> np.ndarray:
        away = np.mod(rows.position - self.angle + np.pi, 2.0 * np.pi) - np.pi
        return self.amplitude * np.exp(-((away / self.width) ** 2))


@dataclass(frozen=True)
class Vibration(Effect):
    """Resisting torque A*sin(2*pi*f*t + phi) from a neighbour that runs; A amplitude - N*m, f frequency - Hz."""

    name: ClassVar[str] = "vibration"
    amplitude: float
    frequency: float
    phase: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(1.2 * about(severity, rng) * axis.torque_scale, rng.uniform(4.0, 35.0), phase(rng))

    def resisting_torque(self, rows: Rows) -> np.ndarray:
        return self.amplitude * np.sin(2.0 * np.pi * self.frequency * rows.time + self.phase)


@dataclass(frozen=True)
class RestHardening(Effect):
    """Level K_0*(1 + A*(1 - m)), m grown by sliding and lost at rest: T*dm/dt = s - m with s = 1 while |w| > w_0.

    Friction peaks after every pause. A relative_amplitude, T time_constant - s, w_0 speed - rad/s.
    """

    name: ClassVar[str] = "rest_hardening"
    relative_amplitude: float
    time_constant: float
    speed: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(3.0 * about(severity, rng), duration * rng.uniform(0.03, 0.08), 0.05 * axis.top_speed)

    def friction_factor(self, rows: Rows) -> np.ndarray:
        return 1.0 + self.relative_amplitude * (1.0 - rows.memory)

    def remember(self, rows: Rows, memory: np.ndarray, step: float) -> np.ndarray:
        sliding = (np.abs(rows.velocity) > self.speed).astype(float)
        return sliding + (memory - sliding) * np.exp(-step / self.time_constant)


OUTSIDE: dict[str, type[Effect]] = {
    kind.name: kind for kind in (SlowMemoryFriction, PositionNotch, Vibration, RestHardening)
}
