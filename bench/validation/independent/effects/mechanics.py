"""Effects of friction and of the load: what the machine brings, and how the motor is joined to it.

A coupling makes two bodies, the sensor on the motor, friction at the motor.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from bench.validation.independent.effects.effect import Effect, Rows, about, phase
from bench.validation.independent.rig import Axis


@dataclass(frozen=True)
class StribeckFriction(Effect):
    """Level K_0 + (K_s - K_0)*exp(-(w/w_s)**2); K_s static friction - N*m, w_s Stribeck speed - rad/s."""

    static_friction: float
    stribeck_velocity: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        rise = (min(0.6, 4.0 * severity) + 1.8 * about(severity, rng)) * axis.coulomb
        return cls(axis.coulomb + rise, axis.top_speed * rng.uniform(0.02, 0.05))

    def friction_excess(self, rows: Rows) -> np.ndarray:
        return (self.static_friction - rows.coulomb) * np.exp(-((rows.velocity / self.stribeck_velocity) ** 2))


@dataclass(frozen=True)
class PreslidingFriction(Effect):
    """LuGre: dz/dt = w - sigma_0*|w|*z/g, friction sigma_0*z + sigma_1*dz/dt; g the level of dry friction.

    sigma_0 bristle_stiffness - N*m/rad, sigma_1 bristle_damping - N*m*s/rad (0: Dahl's model).
    Canudas de Wit et al., IEEE Trans. Automatic Control 40 (1995) 419, eqs. 1-3.
    """

    bristle_stiffness: float
    bristle_damping: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        deflection = axis.top_speed * 2.5e-4 * about(severity, rng)
        stiffness = axis.coulomb / deflection
        return cls(stiffness, rng.uniform(0.0, 0.1) * np.sqrt(stiffness * axis.inertia))

    def bristle_torque(self, rows: Rows, level: np.ndarray, memory: np.ndarray) -> np.ndarray:
        bending = rows.velocity - self.bristle_stiffness * np.abs(rows.velocity) / level * memory
        return self.bristle_stiffness * memory + self.bristle_damping * bending

    def bend(self, speed: np.ndarray, level: np.ndarray, memory: np.ndarray, step: float) -> np.ndarray:
        # exact for constant speed: z tends to g*sgn(w)/sigma_0 at the rate sigma_0*|w|/g
        slid = np.sign(speed) * level / self.bristle_stiffness
        return slid + (memory - slid) * np.exp(-self.bristle_stiffness * np.abs(speed) / level * step)


@dataclass(frozen=True)
class DirectionDependentFriction(Effect):
    """Level K_0 +- d/2 in the two directions, d coulomb_difference - N*m.

    A share of the relative difference d/(2*K_0) may go into viscous friction too.
    """

    coulomb_difference: float
    viscous_share: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        difference = rng.choice([-1.0, 1.0]) * min(1.8 * about(severity, rng), 1.6) * axis.coulomb
        return cls(difference, float(rng.choice([0.0, rng.uniform(0.2, 1.0)])))

    def quantities(self, axis: Axis) -> dict[str, float]:
        relative = self.viscous_share * self.coulomb_difference / axis.coulomb
        return {"coulomb_difference": self.coulomb_difference, "viscous_difference": relative * axis.viscous}

    def friction_difference(self, rows: Rows) -> np.ndarray | float:
        return self.coulomb_difference

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        relative = self.viscous_share * self.coulomb_difference / (2.0 * rows.coulomb)
        return relative * rows.viscous * np.abs(rows.velocity)


@dataclass(frozen=True)
class QuadraticDrag(Effect):
    """Resisting torque c*w*|w|; c quadratic_drag - N*m*s**2/rad**2."""

    quadratic_drag: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(2.0 * about(severity, rng) * axis.torque_scale / axis.top_speed**2)

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        return self.quadratic_drag * rows.velocity * np.abs(rows.velocity)


@dataclass(frozen=True)
class LoadDependentFriction(Effect):
    """Level K_0 + mu*|M|, M motor torque; mu load_friction_coefficient."""

    load_friction_coefficient: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(0.25 * about(severity, rng))

    def friction_excess(self, rows: Rows) -> np.ndarray:
        return self.load_friction_coefficient * np.abs(rows.motor_torque)


@dataclass(frozen=True)
class DirectionalLoadFriction(Effect):
    """Level K_0 + |K_e*M_e - K_m*M|, M_e the load's torque on the gear, against its resistance; BAM's model M5.

    K_m motor_coefficient, load_ratio K_e/K_m. Duclusaud et al., arXiv 2410.08650 (2024).
    """

    never_beside: ClassVar[str] = "load_dependent_friction"
    motor_coefficient: float
    load_ratio: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(0.25 * about(severity, rng), float(rng.uniform(1.5, 4.0)))

    def friction_excess(self, rows: Rows) -> np.ndarray:
        external = -rows.load_torque
        load_coefficient = self.load_ratio * self.motor_coefficient
        return np.abs(load_coefficient * external - self.motor_coefficient * rows.motor_torque)


@dataclass(frozen=True)
class PositionDependentFriction(Effect):
    """Level K_0*(1 + a*sin(q + phi)); a relative_amplitude."""

    on_linear_axis: ClassVar[bool] = False
    relative_amplitude: float
    phase: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        return cls(min(1.2 * about(severity, rng), 0.95), phase(rng))

    def friction_factor(self, rows: Rows) -> np.ndarray:
        return 1.0 + self.relative_amplitude * np.sin(rows.position + self.phase)


@dataclass(frozen=True)
class FrictionWarmup(Effect):
    """Level K_0*(1 + A*exp(-t/T)); A relative_amplitude, T time_constant - s; a share of it on K_w too."""

    relative_amplitude: float
    time_constant: float
    viscous_share: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        share = float(rng.choice([0.0, 1.0]))
        return cls(1.8 * about(severity, rng), duration * rng.uniform(0.2, 0.5), share)

    def _excess(self, rows: Rows) -> np.ndarray:
        return self.relative_amplitude * np.exp(-rows.time / self.time_constant)

    def friction_factor(self, rows: Rows) -> np.ndarray:
        return 1.0 + self._excess(rows)

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        return self.viscous_share * self._excess(rows) * rows.viscous * rows.velocity


@dataclass(frozen=True)
class TorqueOffset(Effect):
    """Constant resisting torque - N*m."""

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


def _reduced(axis: Axis) -> float:
    """Inertia in which motor and load swing against each other, J_m*J_l/(J_m + J_l) - kg*m**2."""
    return axis.rotor_inertia * (axis.inertia - axis.rotor_inertia) / axis.inertia


@dataclass(frozen=True)
class ElasticCoupling(Effect):
    """Torque k*twist + d*d(twist)/dt; k stiffness - N*m/rad, d damping - N*m*s/rad.

    Resonance sqrt(k*(1/J_m + 1/J_l))/(2*pi) - Hz.
    """

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


@dataclass(frozen=True)
class LoadTorqueEvent(Effect):
    """Constant resisting torque - N*m - from start to end - s."""

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
