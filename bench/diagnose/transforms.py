"""What sensing and a soft coupling make of signals: an eccentric encoder, a first-order lag, a second inertia."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.signal
from numpy.typing import NDArray

from bench.effects.effect import Signals

Array = NDArray[np.float64]


def corrected(signals: Signals, eccentricity: tuple[float, ...]) -> Signals:
    """Angle and speed without the encoder's error q_m = q + e_s*sin(q) + e_c*cos(q)."""
    sine, cosine = eccentricity
    angle = signals.position
    for _ in range(4):
        angle = signals.position - sine * np.sin(angle) - cosine * np.cos(angle)
    rate = 1.0 + sine * np.cos(angle) - cosine * np.sin(angle)
    return replace(signals, position=angle, velocity=signals.velocity / rate)


def two_mass(antiresonance: float, damping: float) -> Callable[[Array], NDArray[np.complex128]]:
    """Load's acceleration over the motor's, less one: (1 + 2*d*s/w)/(1 + 2*d*s/w + (s/w)**2) - 1; w - rad/s."""

    def transfer(omega: Array) -> NDArray[np.complex128]:
        s = 1j * omega / antiresonance
        return -(s**2) / (1.0 + 2.0 * damping * s + s**2)

    return transfer


def lagged(values: Array, lag: float, sample_period: float) -> Array:
    """Values (n,) through a first-order lag - s, exact for an input that is straight between samples."""
    x = sample_period / lag
    keep = np.exp(-x)
    now = 1.0 - (1.0 - keep) / x
    return scipy.signal.lfilter([now, 1.0 - keep - now], [1.0, -keep], values, zi=[values[0] * (1.0 - now)])[0]
