"""Effects of the load: torques and inertia that the machine brings, and how the motor is joined to it.

A coupling makes two bodies, the sensor on the motor, friction at the motor.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from bench.validation.independent.effects.effect import Effect, Rows, about, phase
from bench.validation.independent.rig import Axis


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


def _reduced(axis: Axis) -> float:
    """Inertia in which motor and load swing against each other, J_m*J_l/(J_m + J_l) - kg*m**2."""
    return axis.rotor_inertia * (axis.inertia - axis.rotor_inertia) / axis.inertia


@dataclass(frozen=True)
class ElasticCoupling(Effect):
    """Torque k*twist + d*d(twist)/dt; k stiffness - N*m/rad, d damping - N*m*s/rad.

    Resonance sqrt(k*(1/J_m + 1/J_l))/(2*pi) - Hz.
    """

    name: ClassVar[str] = "elastic_coupling"
    never_beside: ClassVar[str] = "backlash"
    stiffness: float
    damping: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        # the velocity loop must stay well below the resonance to be stable
        lowest = 1.3 * axis.velocity_gain / axis.inertia
        frequency = max(2.0 * np.pi * 75.0 * (1.2 - about(severity, rng)), 2.0 * np.pi * 25.0) + 0.7 * lowest
        stiffness = _reduced(axis) * frequency**2
        return cls(stiffness, 2.0 * rng.uniform(0.02, 0.06) * _reduced(axis) * frequency)

    def truth(self, axis: Axis) -> dict[str, float]:
        frequency = float(np.sqrt(self.stiffness / _reduced(axis)) / (2.0 * np.pi))
        return {"resonance_frequency": frequency, "stiffness": self.stiffness, "damping": self.damping}

    def transmitted_torque(self, rows: Rows, twist: np.ndarray, twist_rate: np.ndarray) -> np.ndarray:
        return self.stiffness * twist + self.damping * twist_rate


@dataclass(frozen=True)
class Backlash(Effect):
    """No torque within +-gap/2 of twist, beyond it a stiff contact k*p + d*dp/dt of penetration p that cannot pull.

    gap - rad, contact_stiffness k - N*m/rad, contact_damping d - N*m*s/rad.
    """

    name: ClassVar[str] = "backlash"
    gap: float
    contact_stiffness: float
    contact_damping: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        frequency = 2.0 * np.pi * rng.uniform(120.0, 280.0)
        stiffness = _reduced(axis) * frequency**2
        damping = 2.0 * rng.uniform(0.1, 0.4) * _reduced(axis) * frequency
        return cls(axis.top_speed * 6e-4 * about(severity, rng), stiffness, damping)

    def transmitted_torque(self, rows: Rows, twist: np.ndarray, twist_rate: np.ndarray) -> np.ndarray:
        side = np.sign(twist)
        penetration = np.abs(twist) - self.gap / 2.0
        push = self.contact_stiffness * penetration + self.contact_damping * side * twist_rate
        return np.where(penetration > 0.0, side * np.maximum(push, 0.0), 0.0)
