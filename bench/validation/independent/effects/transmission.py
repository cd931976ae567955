"""Effects of the coupling between motor and load: two bodies, the sensor on the motor, friction at the motor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from bench.validation.independent.effects.effect import Effect, about
from bench.validation.independent.rig import Axis

if TYPE_CHECKING:
    from bench.validation.independent.plant import Rows


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
