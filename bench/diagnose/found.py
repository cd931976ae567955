"""What a diagnosis finds: effects with their quantities, and gaps before and after."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

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
