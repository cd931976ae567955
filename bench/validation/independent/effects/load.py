"""Effects of the load: torques and inertia that the machine brings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from bench.validation.independent.effects.effect import Effect, about, phase
from bench.validation.independent.rig import Axis

if TYPE_CHECKING:
    from bench.validation.independent.plant import Rows


@dataclass(frozen=True)
class TorqueOffset(Effect):
    """Constant resisting torque - N*m."""

    name: ClassVar[str] = "torque_offset"
    never_beside: ClassVar[str] = "direction_dependent_friction"
    transmitted: ClassVar[bool] = True
    torque: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(rng.choice([-1.0, 1.0]) * 1.8 * about(severity, rng) * axis.torque_scale)

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        return self.torque


@dataclass(frozen=True)
class Unbalance(Effect):
    """Eccentric mass under gravity, resisting torque A*sin(q + phi); A = m*g*r amplitude - N*m."""

    name: ClassVar[str] = "unbalance"
    transmitted: ClassVar[bool] = True
    on_linear_axis: ClassVar[bool] = False
    amplitude: float
    phase: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(2.0 * about(severity, rng) * axis.torque_scale, phase(rng))

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        return self.amplitude * np.sin(rows.position + self.phase)


@dataclass(frozen=True)
class TorsionSpring(Effect):
    """Resisting torque k*q; k stiffness - N*m/rad."""

    name: ClassVar[str] = "torsion_spring"
    transmitted: ClassVar[bool] = True
    stiffness: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        # the motions sweep about half a second at top speed
        return cls(2.0 * about(severity, rng) * axis.torque_scale / (0.5 * axis.top_speed))

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        return self.stiffness * rows.position


@dataclass(frozen=True)
class PositionDependentInertia(Effect):
    """J(q) = J*(1 + a*sin(n*q + phi)), resisting torque dJ/dq*w**2/2 (Lagrange); a relative_amplitude, n harmonic."""

    name: ClassVar[str] = "position_dependent_inertia"
    on_linear_axis: ClassVar[bool] = False
    relative_amplitude: float
    harmonic: float
    phase: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        harmonic = float(rng.integers(1, 4))
        torque = 2.0 * about(severity, rng) * axis.torque_scale
        amplitude = torque / (0.5 * harmonic * axis.inertia * (0.6 * axis.top_speed) ** 2)
        return cls(min(amplitude, 0.15), harmonic, phase(rng))

    def added_inertia(self, rows: Rows) -> np.ndarray:
        return rows.inertia * self.relative_amplitude * np.sin(self.harmonic * rows.position + self.phase)

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        slope = rows.inertia * self.relative_amplitude * self.harmonic
        slope = slope * np.cos(self.harmonic * rows.position + self.phase)
        return 0.5 * slope * rows.velocity**2


@dataclass(frozen=True)
class LoadTorqueEvent(Effect):
    """Constant resisting torque - N*m - from start to end - s."""

    name: ClassVar[str] = "load_torque_event"
    start: float
    end: float
    torque: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        length = rng.uniform(0.04, 0.12) * duration
        start = rng.uniform(0.1, 0.8) * duration
        return cls(start, start + length, rng.choice([-1.0, 1.0]) * 1.6 * about(severity, rng) * axis.torque_scale)

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        return self.torque * ((rows.time >= self.start) & (rows.time < self.end))
