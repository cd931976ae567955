"""A fit as effects see it, and what they make of it: what they ask, what they propose, what they read from signals."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.signals import Scope, Signals
from bench.trace.filter import Column

if TYPE_CHECKING:
    from bench.effects.effect import Effect

#: What acts on the load behind a coupling: effect, its shape, its strengths over load inertia.
Load = tuple["Effect", tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class Proposal:
    """A shape of an effect that was tried beside a fit, and the squares it would take from the residual."""

    shape: tuple[float, ...]
    gain: float


@dataclass(frozen=True)
class Detected:
    """An effect read from signals that the torque balance does not hold.

    Attributes:
        values, errors: of its quantities, and their half widths at 95 % - SI.
        evidence: figures that speak for it, by what they are.
    """

    values: Mapping[str, float]
    errors: Mapping[str, float]
    evidence: Mapping[str, float] = field(default_factory=dict)


class FittedTerm(Protocol):
    """A term of a fitted balance: an effect of a shape."""

    @property
    def effect(self) -> Effect: ...  # noqa: D102
    @property
    def shape(self) -> tuple[float, ...]: ...  # noqa: D102


class Fitted(Protocol):
    """A torque balance fitted to a recording, as effects may ask it; see `bench.balance.fit.Fit`."""

    @property
    def theta(self) -> Array: ...  # noqa: D102
    @property
    def owners(self) -> NDArray[np.int64]: ...  # noqa: D102
    @property
    def scope(self) -> Scope: ...  # noqa: D102
    @property
    def terms(self) -> Sequence[FittedTerm]: ...  # noqa: D102
    @property
    def columns(self) -> Array: ...  # noqa: D102
    @property
    def effort(self) -> Array: ...  # noqa: D102
    @property
    def residual(self) -> Array: ...  # noqa: D102
    @property
    def floor(self) -> float: ...  # noqa: D102
    @property
    def time(self) -> Array: ...  # noqa: D102
    @property
    def span(self) -> Array: ...  # noqa: D102
    def seen(self, columns: Callable[[Signals], Sequence[Column]], of_motion: bool) -> Array: ...  # noqa: D102
    def gains(self, columns: Array, width: int) -> Array: ...  # noqa: D102
    def tried(self, effect: Effect, shapes: Sequence[tuple[float, ...]]) -> list[Proposal]: ...  # noqa: D102
