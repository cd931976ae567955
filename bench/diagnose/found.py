"""What a diagnosis finds: effects with their quantities, and gaps before and after."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.balance.parameter import Parameter
from bench.effects.effect import Effect


@dataclass(frozen=True)
class NamedEffect:
    """An effect that the recording shows.

    Attributes:
        effect: what it is.
        parameters: its quantities with interval.
        ambiguous_with: names that this recording cannot tell from it.
        evidence: figures that speak for it, by what they are.
    """

    effect: Effect
    parameters: dict[str, Parameter]
    ambiguous_with: tuple[str, ...]
    evidence: Mapping[str, float]

    @property
    def name(self) -> str:
        """Of the effect, as in the contract."""
        return self.effect.name

    @property
    def values(self) -> dict[str, float]:
        """Of its quantities - SI."""
        return {key: parameter.value for key, parameter in self.parameters.items()}


@dataclass(frozen=True)
class Gap:
    """RMS gap before and after the effects were added, on both recordings, against the noise floor.

    Attributes:
        unit: of all numbers.
        noise_floor: what sensor noise alone leaves.
        identify, holdout: (before, after) over all rows; None where it could not be had.
        judged: share of the rows that the verdict is by, and what is left on them; None where it is by all.
    """

    unit: str
    noise_floor: float
    identify: tuple[float, float] | None
    holdout: tuple[float, float] | None
    judged: tuple[float, float] | None = None


@dataclass(frozen=True)
class Rejected:
    """A name that was not kept.

    Attributes:
        name: of the effect.
        reason: what spoke against it.
    """

    name: str
    reason: str


@dataclass(frozen=True)
class Shrunk:
    """Gaps after one addition to the model.

    Attributes:
        effect: added last; empty for the bare axis.
        torque: of the recording, and of the holdout where there is one - N*m (N).
        velocity: the same - rad/s (m/s); nan where it could not be had.
    """

    effect: str
    torque: tuple[float, ...]
    velocity: tuple[float, ...]


@dataclass(frozen=True)
class Course:
    """One recording over time beside the model as it grew: what each of its steps leaves of speed and torque.

    Attributes:
        name: `recording` or `holdout`.
        origin: of it.
        time: s - (n,).
        velocity: as measured - rad/s (m/s) - (n,).
        velocity_left: measured less simulated, for each step (n,), nan where the model says nothing; None where there
            is no model, or it diverged.
        rows: index into the samples of each row of the torque balance (m,).
        torque: as measured, filtered - N*m (N) - (m,).
        torque_left: measured less modelled, for each step (m,).
    """

    name: str
    origin: str
    time: Array
    velocity: Array
    velocity_left: tuple[NDArray[np.float32] | None, ...]
    rows: NDArray[np.int64]
    torque: Array
    torque_left: tuple[Array, ...]


@dataclass(frozen=True)
class Profile:
    """The gap over one coordinate, before anything was added and after.

    Attributes:
        coordinate: of `bench.diagnose.where`.
        unit: of it.
        share: of the first gap's variance that it accounts for.
        centres: of its bins - unit - (b,).
        before, after: mean of measured less modelled torque in each bin - N*m (N) - (b,); what lies between the two is
            what the added effects account for.
    """

    coordinate: str
    unit: str
    share: float
    centres: Array
    before: Array
    after: Array


@dataclass(frozen=True)
class Considered:
    """An effect of the catalogue, and why it was taken or not.

    Attributes:
        effect: what it is.
        taken: whether it is in the model.
        alone: share of the squared gap that it would take where it was tried first; None where it was not tried.
        beside: share of what is left that it would take beside the others; None where it was not tried.
        reason: for it, or against.
    """

    effect: Effect
    taken: bool
    alone: float | None
    beside: float | None
    reason: str
