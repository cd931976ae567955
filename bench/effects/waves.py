"""Waves of position: their amplitude and phase, and where samples follow them."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.effects.signals import Signals


def amplitude_and_phase(sine: float, cosine: float) -> tuple[float, float]:
    """A, phi of A*sin(x + phi) = sine*sin(x) + cosine*cos(x); phi - rad in (-pi, pi]."""
    return float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))


def followed(signals: Signals, harmonic: float) -> Array:
    """1 where a wave of n cycles a revolution stays below 0.8 of the Nyquist frequency, else 0 - (n,)."""
    return (harmonic * np.abs(signals.velocity) < 0.8 * np.pi / signals.sample_period).astype(float)
