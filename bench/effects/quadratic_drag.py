"""Quadratic drag: resisting torque grows with velocity times its magnitude (a fan, a fluid).

    M = k_q*omega*|omega|

k_q - N*m*s**2/rad**2 (N*s**2/m**2), not negative.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.effects.effect import Base, Column, Effect, Signals
from bench.units import Quantity


class QuadraticDrag(Effect):
    """See the module."""

    name = "quadratic_drag"
    summary = "resisting torque grows with velocity*|velocity|"
    quantities = (Quantity("quadratic_drag", "k_q", "N*m*s**2/rad**2", lower=0.0),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """omega*|omega|."""
        return [[(signals.velocity * np.abs(signals.velocity), 0)]]

    def values(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """The strength itself."""
        return {"quadratic_drag": strengths[0]}


EFFECT = QuadraticDrag()
