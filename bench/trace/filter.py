"""One zero-phase filter for every column of a regression, with its derivatives exact in the frequency domain."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from bench.arrays import Array

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

    def __call__(self, values: NDArray[np.floating], *orders: int) -> Array:
        """Filtered derivatives of one signal over a stretch without holes.

        Args:
            values: (n,) samples, n > 2*margin.
            orders: which derivatives, 0 for the smoothed signal.

        Returns:
            (orders, m), at samples margin, margin + stride, ... below n - margin.
        """
        return self.columns(values[None], *((0, order) for order in orders))

    def columns(self, signals: NDArray[np.floating], *wanted: tuple[int, int]) -> Array:
        """Filtered derivatives of several signals at once, which costs half as much as one after the other.

        Args:
            signals: (k, n) samples.
            wanted: index of the signal and order of its derivative, for each row that comes out.

        Returns:
            (wanted, m), at the samples of `__call__`.
        """
        count = signals.shape[1]
        size = self.stride * fast_length(math.ceil(count / self.stride))
        kept = size // self.stride // 2 + 1
        spectra = _transform(signals, size)[:, :kept]
        frequency = 2.0 * math.pi / (size * self.sample_period) * np.arange(kept)
        spectra = spectra * (np.exp(-0.5 * (frequency * self.width) ** 2) / self.stride)
        rows = np.stack([spectra[k] * (1j * frequency) ** order if order else spectra[k] for k, order in wanted])
        first, last = self.margin // self.stride, -(-(count - self.margin) // self.stride)
        return np.asarray(scipy.fft.irfft(rows, size // self.stride))[:, first:last]


def _transform(signals: NDArray[np.floating], size: int) -> NDArray[np.complex128]:
    return np.asarray(scipy.fft.rfft(signals, size))


def fast_length(length: int) -> int:
    """Shortest length for a fast transform that holds `length` samples."""
    fast = scipy.fft.next_fast_len(length, real=True)
    return length if fast is None else fast
