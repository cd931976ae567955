"""What a physical effect may do to an axis. One frozen dataclass an effect, its parameters named as in truth.json.

The same object serves one axis (fields are numbers) and many (fields are arrays); `stack` makes the latter.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, ClassVar, Self

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
    #: Name of the effect that no axis has beside it, or that no recording tells from it; one of the two says so.
    never_beside: ClassVar[str] = ""

    def __init_subclass__(cls) -> None:
        cls.name = re.sub(r"\B([A-Z])", r"_\1", cls.__name__).lower()

    if TYPE_CHECKING:  # the hooks

        def __getattr__(self, hook: str) -> Any: ...  # noqa: ANN401

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
