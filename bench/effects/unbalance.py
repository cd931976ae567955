"""Unbalance: an eccentric mass under gravity, once per revolution.

    M = A*sin(q + phi), A = m*g*r

A - N*m; q - angle - rad.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.effects.effect import Base, Column, Effect, Signals, amplitude_and_phase
from bench.units import Quantity


class Unbalance(Effect):
    """See the module."""

    name = "unbalance"
    summary = "an eccentric mass under gravity, once per revolution"
    quantities = (Quantity("amplitude", "A", "N*m", lower=0.0), Quantity("phase", "phi", "rad"))

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """sin(q) and cos(q)."""
        return [[(np.sin(signals.position), 0)], [(np.cos(signals.position), 0)]]

    def values(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """Amplitude and phase."""
        amplitude, phase = amplitude_and_phase(*strengths)
        return {"amplitude": amplitude, "phase": phase}


EFFECT = Unbalance()
