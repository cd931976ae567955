"""What a diagnosis finds: effects with their quantities, and gaps before and after."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.effect import Effect
from bench.fit.parameter import Parameter


@dataclass(frozen=True)
class NamedEffect:
    """An effect that the recording shows.

    Attributes:
        effect: of the catalogue.
        parameters: its quantities with intervals.
        ambiguous_with: names of effects that this recording cannot distinguish from it.
        evidence: figures that support it, by name.
    """

    effect: Effect
    parameters: dict[str, Parameter]
    ambiguous_with: tuple[str, ...]
    evidence: Mapping[str, float]

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.effect.name

    @property
    def values(self) -> dict[str, float]:
        """Values of its quantities - SI."""
        return {key: parameter.value for key, parameter in self.parameters.items()}


@dataclass(frozen=True)
class Gap:
    """RMS gap before and after the effects were added, on both recordings, against the noise floor.

    Attributes:
        unit: of all numbers.
        noise_floor: expected RMS from sensor noise alone.
        identify, holdout: (before, after) over all rows; None if not available.
        judged: share of the rows that the verdict is based on, and the gap on them; None if it is all rows.
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
        reason: why.
    """

    name: str
    reason: str


@dataclass(frozen=True)
class Shrunk:
    """Gaps after one addition to the model.

    Attributes:
        effect: added last; empty for the bare axis.
        torque: of the recording, and of the holdout where there is one - N*m (N).
        velocity: the same - rad/s (m/s); nan if not available.
    """

    effect: str
    torque: tuple[float, ...]
    velocity: tuple[float, ...]


@dataclass(frozen=True)
class Course:
    """One recording over time, with the residuals of the model after each addition.

    Attributes:
        name: `recording` or `holdout`.
        origin: of it.
        time: s - (n,).
        velocity: as measured - rad/s (m/s) - (n,).
        velocity_left: measured less simulated, for each step (n,), nan outside the model; None without a model, or
            if it diverged.
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
        coordinate: of `bench.diagnosis.where`.
        unit: of it.
        share: of the first gap's variance that it explains.
        centres: of its bins - unit - (b,).
        before, after: mean of measured less modelled torque in each bin - N*m (N) - (b,), without and with the added
            effects.
    """

    coordinate: str
    unit: str
    share: float
    centres: Array
    before: Array
    after: Array


@dataclass(frozen=True)
class Considered:
    """An effect of the catalogue, and why it was accepted or not.

    Attributes:
        effect: of the catalogue.
        taken: whether it is in the model.
        alone: share of the squared gap that it explains alone; None if it was not tried.
        beside: share of the squared residual that it explains in addition to the others; None if it was not tried.
        reason: for or against it.
    """

    effect: Effect
    taken: bool
    alone: float | None
    beside: float | None
    reason: str
