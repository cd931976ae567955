"""White noise of a signal, read from its highest frequencies, where a servo axis no longer moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import special

#: Samples a window: short enough that most windows of a servo's motion hold no jerk.
WINDOW = 128
#: Share of the spectrum, from the top, that counts as noise.
TOP = 0.3
#: Variance of a mean of neighbouring Hann-weighted periodogram values over that of independent ones:
#: 1 + 2*(2/3)**2 + 2*(1/6)**2 from the window's overlap of one and two bins.
CORRELATION = 35.0 / 18.0


def white_noise(values: NDArray[np.floating]) -> float:
    """Standard deviation of the white noise in a signal, in the signal's unit.

    The median over Hann-weighted windows of the periodogram's mean over its top 30 %: the median keeps jerks and
    events out, which fill the top of few windows. Second differences first, so that a ramp leaks nothing there. The
    median of such a mean, a gamma variable, lies below its expectation by a known factor. Windows in which the signal
    stands still hide their noise below its resolution and are left out.

    Args:
        values: (n,) regular samples.

    Returns:
        Standard deviation; 0 when the signal is shorter than a window, or never changes.
    """
    count = (values.size - 2) // WINDOW
    if count < 1:
        return 0.0
    differences = np.diff(values, 2)[: count * WINDOW].reshape(count, WINDOW)
    differences = differences[differences.any(axis=1)]
    if not differences.size:
        return 0.0
    taper = np.hanning(WINDOW)
    power = np.abs(np.fft.rfft(differences * taper, axis=1)) ** 2 / np.sum(taper**2)
    frequency = np.linspace(0.0, np.pi, WINDOW // 2 + 1)
    top = slice(int((1.0 - TOP) * frequency.size), -1)
    shape = (2.0 * np.sin(frequency[top] / 2.0)) ** 4
    degrees = shape.size / CORRELATION
    median = special.gammaincinv(degrees, 0.5) / degrees
    return float(np.sqrt(np.median(np.mean(power[:, top] / shape, axis=1)) / median))
