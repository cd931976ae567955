"""The state of an axis, from recordings or from a model: everything that is compared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bench.axis_kind import AxisKind, axis_kind
from bench.baseline.response import Response
from bench.comparison.difference import Measured
from bench.effects.effect import Effect

#: Quantities that are not parameters: gaps over their noise floors.
GAPS = TORQUE_GAP, VELOCITY_GAP = "torque_gap", "velocity_gap"
#: Share by which the harmonics of two waves may differ and still be one: the pitch of a linear axis is fitted.
SAME_WAVE = 0.01


@dataclass(frozen=True)
class NamedHere:
    """An effect of a state.

    Attributes:
        effect: what it is.
        quantities: of it.
        shape: in the torque balance, in the effect's order; None for one read directly from signals.
        on_load: whether it acts on the load behind a coupling.
        torque: RMS torque that the rest of the model cannot explain - N*m (N); None outside the torque balance.
        ambiguous_with: names of effects that the recording cannot distinguish from it.
        gain: reduction of the squared residual over that of noise; nan outside the torque balance.
    """

    effect: Effect
    quantities: Mapping[str, Measured]
    shape: tuple[float, ...] | None = None
    on_load: bool = False
    torque: Measured | None = None
    ambiguous_with: tuple[str, ...] = ()
    gain: float = float("nan")

    @property
    def name(self) -> str:
        """Of the effect."""
        return self.effect.name

    @property
    def label(self) -> str:
        """Name, with the harmonic where an axis may have several."""
        waves = [f"{slot.quantity.name} {value:.4g}" for slot, value in self.whole]
        return f"{self.name} ({', '.join(waves)})" if waves else self.name

    @property
    def whole(self) -> list[tuple[Any, float]]:
        """Integer quantities of its shape, with their values."""
        return [pair for pair in zip(self.effect.shapes, self.shape or (), strict=False) if pair[0].whole]

    def same(self, other: NamedHere) -> bool:
        """Whether it is the same effect of the same harmonic."""
        pairs = zip(self.whole, other.whole, strict=False)
        return self.effect is other.effect and all(
            bool(np.isclose(a[1], b[1], rtol=SAME_WAVE, atol=0.0)) for a, b in pairs
        )

    def indistinguishable_from(self, other: NamedHere) -> bool:
        """Whether a recording cannot distinguish the two."""
        return self.name in other.ambiguous_with or other.name in self.ambiguous_with

    @property
    def compared(self) -> dict[str, Measured]:
        """Quantities that are compared: no angles and instants, whose zero is arbitrary, and no integers."""
        whole = {slot.quantity.name for slot, _ in self.whole}
        names = [q.name for q in self.effect.quantities if not (q.angle or q.instant or q.name in whole)]
        return {
            name: self.quantities[name]
            for name in names
            if name in self.quantities and np.isfinite(self.quantities[name].std_error)
        }


@dataclass(frozen=True)
class Gap:
    """A gap that remains with the effects found.

    Attributes:
        after: RMS - unit.
        noise_floor: RMS from noise alone - unit.
        unit: of both.
    """

    after: float
    noise_floor: float
    unit: str


@dataclass(frozen=True)
class Shows:
    """Smallest effects that a recording would have shown.

    Attributes:
        torque: RMS torque from which on an effect with one parameter is significant - N*m (N).
        left: RMS torque that the residual may hide - N*m (N).
    """

    torque: float
    left: float

    def named_from(self, numbers: int) -> float:
        """RMS torque of an effect with so many parameters that the recording would have shown - N*m (N)."""
        return max(self.torque * float(np.sqrt(numbers)), self.left)


@dataclass(frozen=True)
class State:
    """The state of an axis.

    Attributes:
        source: `recordings` or `model`.
        names: whether effects were searched for.
        quantities: parameters and gaps by name.
        effects: in the order in which they were added.
        verdict: of the diagnosis; empty without names.
        gaps: by `torque` and `velocity`.
        shows: smallest effects that the recording would have shown; None without names.
        conditions: motion, sampling and cut-off by name, SI (`bench.baseline.conditions`).
        rig: values that identification reads of the rig, by key (`bench.baseline.same_rig`).
        provenance: version, digests, options.
        response: of a model; None of recordings.
    """

    source: str
    names: bool
    quantities: Mapping[str, Measured]
    effects: tuple[NamedHere, ...] = ()
    verdict: str = ""
    gaps: Mapping[str, Gap] = field(default_factory=dict)
    shows: Shows | None = None
    conditions: Mapping[str, Measured] = field(default_factory=dict)
    rig: Mapping[str, str] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    response: Response | None = None

    @property
    def kind(self) -> AxisKind:
        """Of the axis."""
        return axis_kind(self.rig.get("kind"), "kind")
