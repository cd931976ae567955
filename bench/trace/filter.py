"""One zero-phase filter for every column of a regression, with its derivatives exact in the frequency domain."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from bench.arrays import Array

#: Samples (n,) and the order of the time derivative to be taken of them; a column is a sum of such terms. So products
#: are formed on raw samples and differentiated exactly: q''*sin(q) = (q'*sin(q))' - q'**2*cos(q).
Term = tuple[Array, int]
Column = Sequence[Term]

#: The impulse response and its derivatives are below 1e-6 of their peak beyond this many widths.
REACH = 6.0
#: Smallest width in sample periods: the transfer is then 1.5e-5 at the Nyquist frequency, so nothing folds back.
LEAST_WIDTH = 1.5


@dataclass(frozen=True)
class GaussianFilter:
    """Gaussian low-pass G(omega) = exp(-(omega*width)**2/2) and its k-th derivative (j*omega)**k*G(omega).

    A constant, a ramp and a sine come out in phase; every column sees the same G, so a relation linear between the
    raw columns stays exact between the filtered ones.

    Attributes:
        width: standard deviation of the impulse response - s.
        sample_period: of the samples that come in - s.
        stride: every stride-th sample goes out; more would only repeat what the low-pass left.
    """

    width: float
    sample_period: float
    stride: int = 1

    @classmethod
    def from_cutoff(cls, cutoff: float, sample_period: float) -> GaussianFilter:
        """Filter whose power falls to half at `cutoff` - Hz, thinned to LEAST_WIDTH samples a width, up to twice that.

        The stride is a power of two, as lengths of powers of two transform fastest.

        Bounded below by LEAST_WIDTH sample periods: a higher cut-off cannot be kept at this sampling.
        """
        width = max(math.sqrt(math.log(2.0)) / (2.0 * math.pi * cutoff), LEAST_WIDTH * sample_period)
        return cls(width, sample_period, 2 ** math.floor(math.log2(max(1.0, width / (LEAST_WIDTH * sample_period)))))

    @property
    def cutoff(self) -> float:
        """Frequency of half power - Hz."""
        return math.sqrt(math.log(2.0)) / (2.0 * math.pi * self.width)

    @property
    def margin(self) -> int:
        """Samples at each end that the filter cannot serve, a multiple of the stride."""
        return self.stride * math.ceil(REACH * self.width / self.sample_period / self.stride)

    def noise_gain(self, order: int) -> float:
        """Standard deviation out per standard deviation of white noise in, for the `order`-th derivative - 1/s**order.

        Parseval: integral of (omega**k*G)**2 d(omega)*T/(2*pi) = T*Gamma(k+1/2)/(2*pi*width**(2*k+1)).
        """
        power = math.gamma(order + 0.5) / (2.0 * math.pi * self.width ** (2 * order + 1))
        return math.sqrt(self.sample_period * power)

    def __call__(self, values: Array, *orders: int, lag: float = 0.0) -> Array:
        """Filtered derivatives of one signal over a stretch without holes.

        Args:
            values: (n,) samples, n > 2*margin.
            orders: which derivatives, 0 for the smoothed signal.
            lag: time constant of a first-order lag to undo, 1 + j*omega*lag - s.

        Returns:
            (orders, m), at samples margin, margin + stride, ... below n - margin.
        """
        return self.columns([[(values, order)] for order in orders], lag)

    def columns(self, columns: Sequence[Column], lag: float = 0.0, spectra: Spectra | None = None) -> Array:
        """Filtered sums of derivatives of several signals; a signal that occurs again is transformed once.

        The line between the ends of a signal is filtered by itself, in closed form: a transform takes the stretch for
        one period, and the step from its end back to its start has power at every frequency, of which the filter's
        rest at the Nyquist frequency, 1.5e-5, is not little where a position has run for minutes. Without the line
        clean recordings in one direction, of 1 s and of 300 s left 1.16, 1.30 and 1.39 noise floors, with it 0.96 to
        1.07.

        Args:
            columns: each a sum of terms, samples (n,) and the order of the derivative to be taken of them.
            lag: time constant of a first-order lag to undo, 1 + j*omega*lag - s.
            spectra: transforms of signals that other filters want, too.

        Returns:
            (columns, m), at the samples of `__call__`.
        """
        distinct = {id(values): values for column in columns for values, _ in column}
        place = {key: row for row, key in enumerate(distinct)}
        signals = list(distinct.values())
        count = signals[0].size
        size = self.stride * fast_length(math.ceil(count / self.stride))
        kept = size // self.stride // 2 + 1
        omega = 2.0 * math.pi / (size * self.sample_period) * np.arange(kept)
        gain = np.exp(-0.5 * (omega * self.width) ** 2) / self.stride
        gain = gain * (1.0 + 1j * omega * lag) if lag else gain
        transformed = transformed_of(signals, size) if spectra is None else spectra.of(signals, size)
        slope = (np.array([values[-1] for values in signals]) - [values[0] for values in signals]) / (count - 1)
        first, last = self.margin // self.stride, -(-(count - self.margin) // self.stride)
        at = self.stride * np.arange(first, last)
        sums = np.zeros((len(columns), kept), dtype=complex)
        lines = np.zeros((len(columns), at.size))
        filtered = [spectrum[:kept] * gain for spectrum in transformed]
        for row, column in enumerate(columns):
            for values, order in column:
                k = place[id(values)]
                sums[row] += filtered[k] * (1j * omega) ** order if order else filtered[k]
                if order < 2:
                    rate = float(slope[k]) / self.sample_period
                    lines[row] += rate if order else values[0] + slope[k] * at + lag * rate
        return lines + np.asarray(scipy.fft.irfft(sums, size // self.stride))[:, first:last]


class Spectra:
    """Transforms of the signals of a stretch, for filters of several widths: five cut-offs cost one transform each."""

    def __init__(self) -> None:
        self._known: dict[tuple[int, int], tuple[Array, NDArray[np.complex128]]] = {}

    def of(self, signals: Sequence[Array], size: int) -> list[NDArray[np.complex128]]:
        """Transforms of signals (n,) as of `transformed_of`, those that are new made and kept with their signals."""
        new = [values for values in signals if (id(values), size) not in self._known]
        if new:
            for values, spectrum in zip(new, transformed_of(new, size), strict=True):
                self._known[id(values), size] = values, spectrum
        return [self._known[id(values), size][1] for values in signals]


def transformed_of(signals: Sequence[Array], size: int) -> NDArray[np.complex128]:
    """Transforms (k, size//2 + 1) of signals (n,) less the line between their ends, followed by zeros up to a size."""
    table, count = np.zeros((len(signals), size)), signals[0].size
    at = np.arange(count)
    for row, values in zip(table, signals, strict=True):
        slope = (values[-1] - values[0]) / (count - 1)
        np.subtract(values, values[0] + slope * at, out=row[:count])
    return np.asarray(scipy.fft.rfft(table, overwrite_x=True))


def fast_length(length: int) -> int:
    """Shortest length for a fast transform that holds `length` samples."""
    fast = scipy.fft.next_fast_len(length, real=True)
    return length if fast is None else fast
