"""What a physical effect may do to an axis. One frozen dataclass an effect, its parameters named as in truth.json.

The same object serves one axis (fields are numbers) and many (fields are arrays); `stack` makes the latter.
"""

from __future__ import annotations

import re
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
    effect: Any
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
    """A physical effect, called as its class is. It has the hooks through which it acts, and the plant asks no other.

    `rows` shows the state of the axes that have the effect, midway through the step; `memory` is the effect's own state
    (one number an axis), `step` the time to advance - s. All give (k,), or one number for all axes.

    Of the torque:
        resisting_torque(rows): added to M_load on the motor's side - N*m.
        torque_factor(rows): multiplies motor torque.
        added_inertia(rows): added to the moment of inertia - kg*m**2.
        transmitted_torque(rows, twist, twist_rate): from motor to load when they are separate bodies - N*m; twist is
            motor minus load angle - rad.
    Of dry friction:
        friction_excess(rows): added to its level - N*m.
        friction_difference(rows): level in positive minus level in negative direction - N*m.
        friction_factor(rows): multiplies its level.
        bristle_torque(rows, level, memory): replaces it - N*m; `level` is what it tends to.
        bend(speed, level, memory, step): deflection of the bristles after the step.
        remember(rows, memory, step): the effect's own state after the step.
    Of the current - A:
        driven_current(rows, demand, current, step): after the step, that the drive measures.
        acting_current(current, memory, step): that makes torque, `step` after `memory` was it, while the measured one
            is `current`.
        true_current(rows, reading): that flows while the sensor of the drive reads one.
        recorded_current(current, memory, step): that is recorded, `step` after `memory` was it, while the drive reads
            `current`.
    Of the sensor:
        measured(position, speed): angle and speed as it sees them - rad, rad/s.
        filtered(before, after, memory, step): reported speed after the step, in which the sensed one went from `before`
            to `after` - rad/s.
    """

    name: ClassVar[str]
    on_linear_axis: ClassVar[bool] = True
    #: Whether its resisting torque is one of a load that a gear transmits.
    transmitted: ClassVar[bool] = False
    #: Name of the effect that no axis has beside it, or that no recording tells from it; one of the two says so.
    never_beside: ClassVar[str] = ""

    def __init_subclass__(cls) -> None:
        cls.name = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", cls.__name__).lower()

    @classmethod
    def hooks(cls) -> set[str]:
        """Through which effects of this kind act."""
        return {hook for hook in dir(cls) if not hasattr(Effect, hook)}

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
