"""What a physical effect may do to an axis. One frozen dataclass an effect, its parameters named as in truth.json.

The same object serves one axis (fields are numbers) and many (fields are arrays); `stack` makes the latter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Any, ClassVar, Self

import numpy as np

from bench.validation.independent.rig import Axis


@dataclass
class Rows:
    """State and constants of those axes of a plant that have an effect, as the effect's hooks see them - (k,) each.

    Any other attribute is the plant's array of axes of that name, of those axes alone.

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
        return getattr(self.plant, name)[self.index]

    @property
    def time(self) -> float:
        """Time at the middle of the step - s."""
        return self.plant.midtime


@dataclass(frozen=True)
class Effect:
    """A physical effect. It defines the hooks through which it acts; the plant asks no other one.

    `rows` shows the state of the axes that have the effect, midway through the step; `memory` is the effect's own state
    (one number an axis), `step` the time to advance - s.
    """

    name: ClassVar[str]
    on_linear_axis: ClassVar[bool] = True
    #: Whether its resisting torque is one of a load that a gear transmits.
    transmitted: ClassVar[bool] = False
    #: Name of the effect that no axis has beside it, or that no recording tells from it; one of the two says so.
    never_beside: ClassVar[str] = ""

    @classmethod
    def possible(cls, axis: Axis) -> bool:
        """Whether an axis can have it."""
        return cls.on_linear_axis or not axis.linear

    @classmethod
    def draw(cls, axis: Axis, severity: float, rng: np.random.Generator, duration: float) -> Self:
        """An effect of this kind, as strong as `severity` (1: drastic) says, for a recording of `duration` - s."""
        raise NotImplementedError

    def truth(self, axis: Axis) -> dict[str, float]:
        """Parameters as truth.json names them."""
        return {key: float(value) for key, value in asdict(self).items()}

    def quantities(self, axis: Axis) -> dict[str, float]:
        """Values of the quantities that the contract's effect of this name has."""
        return {key: float(value) for key, value in asdict(self).items()}

    def resisting_torque(self, rows: Rows) -> np.ndarray | float:
        """Added to M_load on the motor's side - N*m."""
        raise NotImplementedError

    def friction_excess(self, rows: Rows) -> np.ndarray:
        """Added to the level of dry friction - N*m."""
        raise NotImplementedError

    def friction_factor(self, rows: Rows) -> np.ndarray:
        """Multiplies the level of dry friction."""
        raise NotImplementedError

    def friction_difference(self, rows: Rows) -> np.ndarray | float:
        """Level in positive minus level in negative direction - N*m."""
        raise NotImplementedError

    def added_inertia(self, rows: Rows) -> np.ndarray:
        """Added to the moment of inertia - kg*m**2."""
        raise NotImplementedError

    def torque_factor(self, rows: Rows) -> np.ndarray | float:
        """Multiplies motor torque."""
        raise NotImplementedError

    def remember(self, rows: Rows, memory: np.ndarray, step: float) -> np.ndarray:
        """The effect's own state after the step."""
        raise NotImplementedError

    def bristle_torque(self, rows: Rows, level: np.ndarray, memory: np.ndarray) -> np.ndarray:
        """Friction torque that replaces dry friction - N*m; `level` is what it tends to."""
        raise NotImplementedError

    def bend(self, speed: np.ndarray, level: np.ndarray, memory: np.ndarray, step: float) -> np.ndarray:
        """Deflection of the bristles after the step."""
        raise NotImplementedError

    def transmitted_torque(self, rows: Rows, twist: np.ndarray, twist_rate: np.ndarray) -> np.ndarray:
        """Torque from motor to load when they are separate bodies - N*m; twist = motor minus load angle - rad."""
        raise NotImplementedError

    def driven_current(self, rows: Rows, demand: np.ndarray, current: np.ndarray, step: float) -> np.ndarray:
        """Current after the step, that the drive measures - A."""
        raise NotImplementedError

    def acting_current(self, current: np.ndarray, memory: np.ndarray, step: float) -> np.ndarray:
        """Current that makes torque, `step` after `memory` was it, while the measured one is `current` - A."""
        raise NotImplementedError

    def true_current(self, rows: Rows, reading: np.ndarray) -> np.ndarray:
        """Current that flows while the sensor of the drive reads one - A."""
        raise NotImplementedError

    def recorded_current(self, current: np.ndarray, memory: np.ndarray, step: float) -> np.ndarray:
        """Current that is recorded, `step` after `memory` was it, while the drive reads `current` - A."""
        raise NotImplementedError

    def measured(self, position: np.ndarray, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Angle and speed as the sensor sees them - rad, rad/s."""
        raise NotImplementedError

    def filtered(self, before: np.ndarray, after: np.ndarray, memory: np.ndarray, step: float) -> np.ndarray:
        """Reported speed after the step, in which the sensed one went from `before` to `after` - rad/s."""
        raise NotImplementedError


def stack(effects: Sequence[Effect]) -> Effect:
    """One effect on many axes from one on each: same class, fields as arrays - (n,)."""
    kind = type(effects[0])
    return kind(**{f.name: np.array([getattr(e, f.name) for e in effects], dtype=float) for f in fields(kind)})


def phase(rng: np.random.Generator) -> float:
    """Any angle - rad."""
    return float(rng.uniform(-np.pi, np.pi))


def about(severity: float, rng: np.random.Generator) -> float:
    """Severity with some spread, so that it does not tell the parameter."""
    return float(severity * rng.uniform(0.8, 1.25))
