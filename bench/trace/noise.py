"""Noise of a signal: white, read from its highest frequencies, where a servo axis no longer moves; and its last digit.

A signal that is reported in steps, as an encoder's position is, has the error

    e = q*round(x/q) - x

q - step; x - the signal. Where x crosses steps at a changing rate the error is white, q**2/12. Where it runs evenly the
error repeats with the fraction of a step at each sample: lines, which sampling folds to anywhere, and
which within the band of the motion are many times as strong as white noise of that power, or next to nothing.
Source: B. Widrow, I. Kollar, Quantization Noise, 2008.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy  # its special functions load when first used: 0.2 s

from bench.arrays import Array
from bench.trace.filter import GaussianFilter

#: Samples a window: short enough that most windows of a servo's motion hold no jerk; shorter ones where stretches are.
WINDOWS = (128, 64, 32)
#: Share of the samples that must lie in whole windows of a length for it to be taken.
HELD = 0.5
#: Power of a window over the median above which it is a jerk: a change of pose makes less of a difference.
JERK = 30.0
#: Share of the spectrum, from the top, that counts as noise.
TOP = 0.3
#: Variance of a mean of neighbouring Hann-weighted periodogram values over that of independent ones:
#: 1 + 2*(2/3)**2 + 2*(1/6)**2 from the window's overlap of one and two bins.
CORRELATION = 35.0 / 18.0
#: Samples a distinct value at least, on average, in a signal whose steps can be evaluated.
REPEATED = 4
#: Samples that mostly show that there is no step of which all distances are multiples.
FEW = 512
#: Share of a step below which a distance is rounding of numbers, not a step.
TOLERANCE = 1e-3
#: Widths of the recording's filter over which the way is smoothed, so that lines within its band are not taken for it.
SMOOTHER = 8.0
#: Samples of a stretch at least.
SHORTEST = 64
#: Samples of a window of the spectrum at most, and fractions of a step at which it is rounded. Windows of 256 smeared
#: a line over the width of a coupling that takes it away.
WINDOW, PHASES = 4096, (0.0, 0.25, 0.5, 0.75)


def white_noise(*stretches: Array) -> float:
    """Standard deviation of the white noise in a signal, in the signal's unit.

    The median over Hann-weighted windows of the periodogram's mean over its top 30 %: the median keeps jerks and
    events out, which fill the top of few windows. Second differences first, so that a ramp leaks nothing there. The
    median of such a mean, a gamma variable, lies below its expectation by a known factor. Windows in which the signal
    stands still hide their noise below its resolution and are left out.

    Args:
        stretches: regular samples (n,) without a hole, one or several; 0 comes of them when all are shorter than a
            window, or the signal never changes.
    """
    powers, median = _powers(stretches)
    return float(np.sqrt(np.median(powers) / median)) if powers.size else 0.0


def varying_noise(*stretches: Array) -> float:
    """The same of noise that grows and falls with the motion: the mean over all windows but those of jerks."""
    powers, _ = _powers(stretches)
    powers = powers[powers <= JERK * np.median(powers)] if powers.size else powers
    return float(np.sqrt(np.mean(powers))) if powers.size else 0.0


def _powers(stretches: Sequence[Array]) -> tuple[Array, float]:
    """Variances of the noise in windows (k,) - unit squared -, and the median of such an estimate over its mean."""
    samples = sum(values.size for values in stretches)
    sizes = {window: sum(max(values.size - 2, 0) // window * window for values in stretches) for window in WINDOWS}
    window = next((window for window, size in sizes.items() if size >= HELD * samples), WINDOWS[-1])
    steps = [np.diff(values, 2) for values in stretches if values.size >= window + 2]
    whole = [one[: one.size // window * window].reshape(-1, window) for one in steps]
    differences = np.concatenate(whole) if whole else np.empty((0, window))
    differences = differences[differences.any(axis=1)]
    taper = np.hanning(window)
    frequency = np.linspace(0.0, np.pi, window // 2 + 1)
    top = slice(int((1.0 - TOP) * frequency.size), -1)
    shape = (2.0 * np.sin(frequency[top] / 2.0)) ** 4 * np.sum(taper**2)
    power = np.abs(np.fft.rfft(differences * taper, axis=1)[:, top]) ** 2
    degrees = shape.size / CORRELATION
    return power @ (1.0 / shape) / shape.size, float(scipy.special.gammaincinv(degrees, 0.5) / degrees)


def resolution(values: Array) -> float:
    """Step between the values (n,) that a signal takes, in its unit; 0 where hardly a value occurs twice.

    The median, as steps that no sample fell on are missing, and a torque of a saturating motor has uneven ones.
    """
    if np.unique(values[: 2 * values.size // REPEATED]).size > values.size / REPEATED:
        return 0.0  # which half of them show in half the time
    levels = np.unique(values)
    return float(np.median(np.diff(levels))) if 1 < levels.size <= values.size / REPEATED else 0.0


def common_step(values: Array, least: float) -> float:
    """The step of which all distances between values (n,) are multiples; 0 where that is no larger than `least`.

    By Euclid's algorithm on all distances at once, so that steps that no sample fell on do no harm.
    """
    precise = 8.0 * np.finfo(float).eps * float(np.abs(values).max(initial=0.0))
    distances = np.empty(0)
    for some in (values[:FEW], values):
        distances = np.diff(np.unique(some))
        distances = distances[distances > precise]
        if np.any(distances <= least):
            return 0.0
    while distances.size:
        step = float(distances.min())
        if step <= max(least, precise):
            return 0.0
        left = np.abs(distances - step * np.round(distances / step))
        left = left[left > max(TOLERANCE * step, precise)]
        if not left.size:
            return step
        distances = np.append(left, step)
    return 0.0


def rounding_spectrum(stretches: Sequence[Array], smooth: GaussianFilter, step: float) -> tuple[Array, Array]:
    """Angular frequencies - rad/s (k,) - and the power of rounding there - the signal's unit squared (k,).

    White noise of a variance has that value at all frequencies. The way is read from the signal itself - stretches of
    regular samples (n,) without a hole -, smoothed.
    """
    every = replace(smooth, width=SMOOTHER * smooth.width, stride=1)
    omega = np.pi / smooth.sample_period * np.linspace(0.0, 1.0, WINDOW // 2 + 1)
    total, samples = np.zeros(omega.size), 0
    for values in stretches:
        length = min(WINDOW, values.size - 2 * every.margin)
        if length < SHORTEST:
            continue
        (way,) = every(values, 0)
        taper = np.hanning(length)
        for phase in PHASES:
            steps = way / step + phase
            error = step * (np.round(steps) - steps)
            cut = np.lib.stride_tricks.sliding_window_view(error, length)[:: max(1, length // 2)]
            power = np.abs(np.fft.rfft(cut * taper, WINDOW, axis=1)) ** 2 / np.sum(taper**2)
            total, samples = total + length * power.sum(axis=0), samples + length * cut.shape[0]
    return omega, total / max(samples, 1)
