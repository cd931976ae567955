"""Physical effects of the independent axis: those of the bench's catalogue, their parameters named as in truth.json.

The same object serves one axis (fields are numbers) and many (fields are arrays); `rig.stack` makes the latter. A
coupling makes two bodies, the sensor on the motor, friction at the motor. The mechanics do not feel the faults of what
is measured, except through the drive, which regulates what its sensors read; a filter of the recorded current is the
recorder's alone.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from bench.validation.independent.rig import Axis


@dataclass
class Rows:
    """State and constants of those axes of a plant that have an effect, as the effect's hooks see them - (k,) each.

    Any other attribute is the plant's state of that name, or a constant of its axes, of those axes alone.

    Attributes:
        plant: that they belong to.
        index: of those axes.
        effect: stacked over them.
        memory, level: the effect's own state, and the level of dry friction that its bristles tend to.
    """

    plant: Any
    index: np.ndarray | slice
    effect: Effect
    memory: np.ndarray = field(init=False)
    level: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        self.memory = np.zeros_like(self.velocity)

    def __getattr__(self, name: str) -> np.ndarray:
        state = vars(self.plant)
        return (state[name] if name in state else getattr(self.plant.axes, name))[self.index]

    @property
    def time(self) -> float:
        """Time at the middle of the step - s."""
        return self.plant.midtime


@dataclass(frozen=True)
class Effect(ABC):
    """A physical effect. It acts through those of these hooks that its class defines; all else is the plant's.

    `rows` shows the axes that have it, midway through the step; `memory` is its own state (one number an axis), `step`
    the time to advance - s. Currents - A, angles - rad, torques - N*m:

        resisting_torque(rows)                          added to M_load on the motor's side
        friction_excess(rows)                           added to the level of dry friction
        friction_factor(rows)                           multiplies the level of dry friction
        friction_difference(rows)                       level in positive minus level in negative direction
        added_inertia(rows)                             added to the moment of inertia - kg*m**2
        torque_factor(rows)                             multiplies motor torque
        remember(rows, memory, step)                    its own state after the step
        bristle_torque(rows, level, memory)             replaces dry friction; `level` is what it tends to
        bend(speed, level, memory, step)                deflection of the bristles after the step
        transmitted_torque(rows, twist, twist_rate)     from motor to load as separate bodies; twist = motor less load
        driven_current(rows, demand, current, step)     after the step, as the drive measures it
        acting_current(current, memory, step)           makes torque, `step` after `memory`; `current` is the measured
        true_current(rows, reading)                     flows while the drive's sensor reads one
        recorded_current(current, memory, step)         is recorded, `step` after `memory`; the drive reads `current`
        measured(position, speed)                       angle and speed - rad/s - as the sensor sees them
        filtered(before, after, memory, step)           reported speed - rad/s - as the sensed one changes in a step
    """

    name: ClassVar[str]
    on_linear_axis: ClassVar[bool] = True
    #: Whether its resisting torque is one of a load that a gear transmits.
    transmitted: ClassVar[bool] = False
    #: Name of the effect that no axis has together with it, or that no recording distinguishes from it; one of the two
    #: names it.
    excludes: ClassVar[str] = ""

    def __init_subclass__(cls) -> None:
        cls.name = re.sub(r"\B([A-Z])", r"_\1", cls.__name__).lower()

    if TYPE_CHECKING:  # the hooks

        def __getattr__(self, hook: str) -> Any: ...  # noqa: ANN401

    @classmethod
    def possible(cls, axis: Axis) -> bool:
        """Whether an axis can have it."""
        return cls.on_linear_axis or not axis.linear

    @classmethod
    @abstractmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        """An effect of this kind, as strong as by `severity` (1: drastic), for a recording of `duration` - s."""

    def quantities(self, axis: Axis) -> dict[str, float]:
        """Values of the quantities that the contract's effect of this name has."""
        return {key: float(value) for key, value in asdict(self).items()}


def phase(rng: np.random.Generator) -> float:
    """Any angle - rad."""
    return float(rng.uniform(-np.pi, np.pi))


def about(severity: float, rng: np.random.Generator) -> float:
    """Severity with some spread, so that it does not reveal the parameter."""
    return float(severity * rng.uniform(0.8, 1.25))


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

    excludes: ClassVar[str] = LoadDependentFriction.name
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

    excludes: ClassVar[str] = DirectionDependentFriction.name
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
    """Resisting torque k*(q - q_0); k stiffness - N*m/rad -, q_0 reference - rad."""

    transmitted: ClassVar[bool] = True
    stiffness: float
    reference: float = 0.0

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        # the motions sweep about half a second at top speed
        return cls(2.0 * about(severity, rng) * axis.torque_scale / (0.5 * axis.top_speed))

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        return self.stiffness * (rows.position - self.reference)


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

    stiffness: float
    damping: float

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        # the velocity loop must stay well below the resonance to be stable
        lowest = 1.3 * axis.velocity_gain / axis.inertia
        frequency = max(2.0 * np.pi * 75.0 * (1.2 - about(severity, rng)), 2.0 * np.pi * 25.0) + 0.7 * lowest
        stiffness = _reduced(axis) * frequency**2
        return cls(stiffness, 2.0 * rng.uniform(0.02, 0.06) * _reduced(axis) * frequency)

    def transmitted_torque(self, rows: Rows, twist: np.ndarray, twist_rate: np.ndarray) -> np.ndarray:
        return self.stiffness * twist + self.damping * twist_rate


@dataclass(frozen=True)
class Backlash(Effect):
    """No torque within +-gap/2 of twist, beyond it a stiff contact k*p + d*dp/dt of penetration p that cannot pull.

    gap - rad, contact_stiffness k - N*m/rad, contact_damping d - N*m*s/rad.
    """

    excludes: ClassVar[str] = ElasticCoupling.name
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

    excludes: ClassVar[str] = CurrentLoopLag.name
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


_LATER = (CurrentFilterLag, CurrentGainAsymmetry, CurrentOffsetDrift, TorqueConstantDrift, DirectionalLoadFriction)
#: Drawn as a group of their own, so that a case of another group stays what it is.
LATER = {kind.name: kind for kind in _LATER}
CATALOGUE = {kind.name: kind for kind in Effect.__subclasses__() if kind not in _LATER}
KINDS = CATALOGUE | LATER


def any_effects(
    count: int, rng: np.random.Generator, *, linear: bool = False, without: frozenset[str] = frozenset()
) -> tuple[str, ...]:
    """Names of `count` effects of the catalogue that can be hidden together, on a linear axis or without some."""
    allowed = [name for name, kind in CATALOGUE.items() if (kind.on_linear_axis or not linear) and name not in without]
    while True:
        names = tuple(str(name) for name in rng.choice(allowed, count, replace=False))
        if not any(KINDS[name].excludes in names for name in names):
            return names
