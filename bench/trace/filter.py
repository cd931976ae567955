"""One zero-phase filter for every column of a regression, with its derivatives exact in the frequency domain."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.typing import NDArray

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
        """Filter whose power falls to half at `cutoff` - Hz, thinned to LEAST_WIDTH samples a width.

        Bounded below by LEAST_WIDTH sample periods: a higher cut-off cannot be kept at this sampling.
        """
        width = max(math.sqrt(math.log(2.0)) / (2.0 * math.pi * cutoff), LEAST_WIDTH * sample_period)
        return cls(width, sample_period, max(1, math.floor(width / (LEAST_WIDTH * sample_period))))

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

    def __call__(self, values: NDArray[np.floating], *orders: int) -> list[NDArray[np.float64]]:
        """Filtered derivatives of a stretch without holes.

        Args:
            values: (n,) samples, n > 2*margin.
            orders: which derivatives, 0 for the smoothed signal.

        Returns:
            One array (m,) per order: at samples margin, margin + stride, ... below n - margin.
        """
        size = self.stride * _fast_length(math.ceil(values.size / self.stride))
        spectrum = np.fft.rfft(values, size)[: size // self.stride // 2 + 1]
        frequency = 2.0 * math.pi / (size * self.sample_period) * np.arange(spectrum.size)
        spectrum *= np.exp(-0.5 * (frequency * self.width) ** 2) / self.stride
        first, last = self.margin // self.stride, -(-(values.size - self.margin) // self.stride)
        return [
            np.fft.irfft(spectrum * (1j * frequency) ** order if order else spectrum, size // self.stride)[first:last]
            for order in orders
        ]


def _fast_length(length: int) -> int:
    """Shortest length for a fast transform that holds `length` samples."""
    fast = scipy.fft.next_fast_len(length, real=True)
    return length if fast is None else fast
