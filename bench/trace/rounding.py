"""Noise of a signal that is reported in steps, as an encoder's position is.

    e = q*round(x/q) - x

q - step; x - the signal. Where x crosses steps at a changing rate the error is white, q**2/12. Where it runs evenly the
error repeats with the fraction of a step that is left at each sample: lines, which sampling folds to anywhere, and
which within the band of the motion are many times as strong as white noise of that power, or next to nothing.
Source: B. Widrow, I. Kollar, Quantization Noise, 2008.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.arrays import Array
from bench.trace.filter import GaussianFilter

#: Share of a step below which a distance is rounding of numbers, not a step.
TOLERANCE = 1e-3
#: Widths of the recording's filter over which the way is smoothed, so that lines within its band are not taken for it.
SMOOTHER = 8.0
#: Samples of a stretch at least.
SHORTEST = 64
#: Samples of a window of the spectrum at most, and fractions of a step at which it is rounded. Windows of 256 smeared
#: a line over the width of a coupling that takes it away.
WINDOW, PHASES = 4096, (0.0, 0.25, 0.5, 0.75)


def common_step(values: Array, least: float) -> float:
    """The step of which all distances between values (n,) are multiples; 0 where that is no larger than `least`.

    By Euclid's algorithm on all distances at once, so that steps that no sample fell on do no harm.
    """
    levels = np.unique(values)
    distances = np.diff(levels)
    precise = 8.0 * np.finfo(float).eps * float(np.abs(values).max(initial=0.0))
    distances = distances[distances > precise]
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
    """Angular frequencies - rad/s (k,) - and the power of what rounding leaves there - the signal's unit squared (k,).

    White noise of a variance has that value at all frequencies. The way is read from the signal itself, smoothed.

    Args:
        stretches: regular samples (n,) without a hole.
        smooth: tells the way from the steps.
        step: q.
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
