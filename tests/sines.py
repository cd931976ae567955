"""Motions that are sums of sines, in closed form."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def sines(time: np.ndarray, waves: Sequence[tuple[float, float, float]]) -> np.ndarray:
    """Position - rad -, speed and acceleration (3, n).

    Args:
        time: (n,) - s.
        waves: amplitude of the position - rad -, frequency - Hz - and phase - rad - of each.
    """
    amplitude, frequency, phase = np.array(waves).T[:, :, None]
    omega = 2.0 * np.pi * frequency
    sine, cosine = np.sin(omega * time + phase), np.cos(omega * time + phase)
    return np.stack([amplitude * sine, amplitude * omega * cosine, -amplitude * omega**2 * sine]).sum(axis=1)
