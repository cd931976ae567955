"""One zero-phase filter for every column of a regression, with its derivatives exact in the frequency domain."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
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
        """Filtered derivatives (orders, m) of one signal, at samples margin, margin + stride, ... below n - margin.

        Args:
            values: samples (n,) of a stretch without holes, n > 2*margin.
            orders: which derivatives, 0 for the smoothed signal.
            lag: time constant of a first-order lag to undo, 1 + j*omega*lag - s.
        """
        return self.columns([[(values, order)] for order in orders], lag)

    def columns(
        self, columns: Sequence[Column], lag: float | Sequence[float] = 0.0, spectra: Spectra | None = None
    ) -> Array:
        """Filtered sums of derivatives of several signals (columns, m); a signal that occurs again is transformed once.

        The line between the ends of a signal is filtered by itself, in closed form: a transform takes the stretch for
        one period, and the step from its end back to its start has power at every frequency, of which the filter's
        rest at the Nyquist frequency, 1.5e-5, is not little where a position has run for minutes. Without the line
        clean recordings in one direction, of 1 s and of 300 s left 1.16, 1.30 and 1.39 noise floors, with it 0.96 to
        1.07.

        Args:
            columns: each a sum of terms, samples (n,) and the order of the derivative to be taken of them.
            lag: time constant of a first-order lag to undo, 1 + j*omega*lag, of all columns or of each - s.
            spectra: transforms of signals that other filters want, too.
        """
        count = columns[0][0][0].size
        size, omega, at = self._layout(count)
        kept, first, last = omega.size, at[0] // self.stride, at[-1] // self.stride + 1
        orders = {order for column in columns for _, order in column}
        gains = {order: self._gain(omega, order) / self.stride for order in orders}
        spectra = Spectra() if spectra is None else spectra
        found = np.empty((len(columns), at.size))
        for row, column, late in zip(found, columns, np.broadcast_to(lag, len(columns)).tolist(), strict=True):
            total = np.zeros(kept, dtype=complex)
            constant, slope = 0.0, 0.0
            for values, order in column:
                total += spectra.of(values, size)[:kept] * gains[order]
                if order < 2:
                    rise = float(values[-1] - values[0]) / (count - 1)
                    rate = rise / self.sample_period
                    constant += rate if order else float(values[0]) + late * rate
                    slope += 0.0 if order else rise
            if late:
                total *= 1.0 + 1j * omega * late
            row[:] = np.fft.irfft(total, size // self.stride)[first:last]
            row += constant + slope * at
        return found

    def backwards(self, targets: Array, count: int, order: int, lag: float = 0.0) -> Array:
        """The transpose of `columns`: products (t, n) with `count` samples that filtered they have with targets (t, m).

        So many columns are held against few targets without a transform of each.
        """
        size, omega, at = self._layout(count)
        placed = np.zeros((len(targets), size // self.stride))
        placed[:, at // self.stride] = targets
        spectrum = np.fft.rfft(placed) * (self._gain(omega, order) * (1.0 + 1j * omega * lag)).conj()
        if self.stride > 1 and not placed.shape[1] % 2:
            spectrum[:, -1] *= 0.5  # what is the Nyquist frequency of the rows is none of the samples
        found = np.fft.irfft(np.pad(spectrum, ((0, 0), (0, size // 2 + 1 - omega.size))), size)[:, :count]
        total, share, rate = targets.sum(axis=1), np.arange(count) / (count - 1), 1.0 / (count - 1) / self.sample_period
        last = targets @ at / (count - 1) + lag * rate * total if order == 0 else rate * total * (order == 1)
        first = total * (order == 0) - last
        straight = found @ share
        found[:, 0] += first - (found.sum(axis=1) - straight)
        found[:, -1] += last - straight
        return found

    def _layout(self, count: int) -> tuple[int, Array, NDArray[np.intp]]:
        """Length of the transform of so many samples, angular frequencies kept - rad/s -, and samples that go out."""
        size = self.stride * fast_length(math.ceil(count / self.stride))
        omega = 2.0 * math.pi / (size * self.sample_period) * np.arange(size // self.stride // 2 + 1, dtype=np.float64)
        return size, omega, np.arange(self.margin, count - self.margin, self.stride)

    def _gain(self, omega: Array, order: int) -> NDArray[Any]:
        gain = np.exp(-0.5 * (omega * self.width) ** 2)
        return (1j * omega) ** order * gain if order else gain


class Spectra:
    """Transforms of the signals of a stretch, for filters of several widths: five cut-offs cost one transform each."""

    def __init__(self) -> None:
        self._known: dict[tuple[int, int], tuple[Array, NDArray[np.complex128]]] = {}

    def of(self, values: Array, size: int) -> NDArray[np.complex128]:
        """Transform (size//2 + 1,) of a signal (n,) less the line between its ends, followed by zeros up to a size.

        It is kept with its signal. One at a time: tables of several are so large that each is paged in anew.
        """
        if (id(values), size) not in self._known:
            straight = np.linspace(values[0], values[-1], values.size)
            self._known[id(values), size] = values, np.fft.rfft(values - straight, size)
        return self._known[id(values), size][1]


@cache
def fast_length(length: int) -> int:
    """Shortest product of powers of 2, 3 and 5 that is not below a length, as `scipy.fft.next_fast_len`.

    Its import takes 0.15 s; NumPy's transforms take as long as SciPy's.
    """
    odd = (3**i * 5**j for i in range(length.bit_length()) for j in range(length.bit_length() // 2 + 1))
    return min(m << (-(-length // m) - 1).bit_length() for m in odd)
