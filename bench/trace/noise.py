"""White noise of a signal, read from its highest frequencies, where a servo axis no longer moves; its last digit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import special

#: Samples a window: short enough that most windows of a servo's motion hold no jerk; shorter ones where stretches are.
WINDOWS = (128, 64, 32)
#: Share of the samples that must lie in whole windows of a length for it to be taken.
HELD = 0.5
#: Share of the spectrum, from the top, that counts as noise.
TOP = 0.3
#: Variance of a mean of neighbouring Hann-weighted periodogram values over that of independent ones:
#: 1 + 2*(2/3)**2 + 2*(1/6)**2 from the window's overlap of one and two bins.
CORRELATION = 35.0 / 18.0
#: Samples a distinct value at least, on average, in a signal of whose steps anything can be told.
REPEATED = 4


def white_noise(*stretches: NDArray[np.floating]) -> float:
    """Standard deviation of the white noise in a signal, in the signal's unit.

    The median over Hann-weighted windows of the periodogram's mean over its top 30 %: the median keeps jerks and
    events out, which fill the top of few windows. Second differences first, so that a ramp leaks nothing there. The
    median of such a mean, a gamma variable, lies below its expectation by a known factor. Windows in which the signal
    stands still hide their noise below its resolution and are left out.

    Args:
        stretches: regular samples (n,) without a hole, one or several.

    Returns:
        Standard deviation; 0 when all stretches are shorter than a window, or the signal never changes.
    """
    samples = sum(values.size for values in stretches)
    cut = {window: _windows(stretches, window) for window in WINDOWS}
    held = (window for window in WINDOWS if cut[window].size >= HELD * samples)
    window = next(held, WINDOWS[-1])
    differences = cut[window]
    differences = differences[differences.any(axis=1)]
    if not differences.size:
        return 0.0
    taper = np.hanning(window)
    power = np.abs(np.fft.rfft(differences * taper, axis=1)) ** 2 / np.sum(taper**2)
    frequency = np.linspace(0.0, np.pi, window // 2 + 1)
    top = slice(int((1.0 - TOP) * frequency.size), -1)
    shape = (2.0 * np.sin(frequency[top] / 2.0)) ** 4
    degrees = shape.size / CORRELATION
    median = special.gammaincinv(degrees, 0.5) / degrees
    return float(np.sqrt(np.median(np.mean(power[:, top] / shape, axis=1)) / median))


def _windows(stretches: tuple[NDArray[np.floating], ...], window: int) -> NDArray[np.floating]:
    """Second differences of the stretches in whole windows that span no hole (k, window)."""
    parts = [np.diff(values, 2) for values in stretches if values.size >= window + 2]
    rows = [part[: part.size // window * window].reshape(-1, window) for part in parts]
    return np.concatenate(rows) if rows else np.empty((0, window))


def resolution(values: NDArray[np.floating]) -> float:
    """Step between the values that a signal takes, in its unit; 0 where hardly a value occurs twice.

    The median, as steps that no sample fell on are missing, and a torque of a saturating motor has uneven ones.

    Args:
        values: (n,) samples.
    """
    levels = np.unique(values)
    return float(np.median(np.diff(levels))) if 1 < levels.size <= values.size / REPEATED else 0.0
