"""Torsion spring: a torque proportional to position (a hose, a cable).

    M = c*q

c - stiffness - N*m/rad (N/m), not negative; q - position - rad (m). A rest position other than zero is a torque offset.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from bench.effects.effect import Base, Column, Effect, Signals
from bench.units import Quantity


class TorsionSpring(Effect):
    """See the module."""

    name = "torsion_spring"
    summary = "a torque proportional to position"
    quantities = (Quantity("stiffness", "c", "N*m/rad", lower=0.0),)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """q."""
        return [[(signals.position, 0)]]

    def values(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """The strength itself."""
        return {"stiffness": strengths[0]}


EFFECT = TorsionSpring()
