"""One zero-phase filter for every column of a regression, with its derivatives.

The derivatives of a Gaussian are Hermite's polynomials times it. On samples those that are orthogonal over the samples
take their place, so that the k-th derivative of every polynomial below degree k is zero but for rounding, that of a
power k exactly its own, and nothing depends on where a recording begins and ends. Many samples pass at once as a
product of two matrices, some five times as fast as by transforms.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

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

    @cached_property
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
        self,
        columns: Sequence[Column],
        lag: float | Sequence[float] = 0.0,
        places: NDArray[np.intp] | None = None,
    ) -> Array:
        """Filtered sums of derivatives of several signals (columns, m).

        Args:
            columns: each a sum of terms, samples (n,) and the order of the derivative to be taken of them.
            lag: time constant of a first-order lag to undo, 1 + j*omega*lag, of all columns or of each - s.
            places: of the rows that are wanted (m,); all of them by default.
        """
        count = columns[0][0][0].size
        size, blocks = self._layout(count)
        rows = self._rows(count)
        found = np.empty((len(columns), rows if places is None else places.size))
        windows, row = np.zeros((blocks + 1, size)), np.empty((blocks, size // self.stride))
        padded, laid = windows.reshape(-1), None
        for out, column, late in zip(found, columns, np.broadcast_to(lag, len(columns)).tolist(), strict=True):
            for place, (values, order) in enumerate(column):
                if values is not laid:
                    padded[:count] = laid = values
                passed = _passed(self, size, order, late)
                ahead, behind = passed[:size], passed[size:]
                if place:
                    row += windows[:-1] @ ahead
                else:
                    np.matmul(windows[:-1], ahead, out=row)
                row += windows[1:] @ behind
            out[:] = row.ravel()[:rows] if places is None else row.take(places)
        return found

    def backwards(self, targets: Array, count: int, order: int, lag: float = 0.0) -> Array:
        """The transpose of `columns`: products (t, n) with `count` samples that filtered they have with targets (t, m).

        So many columns are held against few targets without each being filtered.
        """
        size, blocks = self._layout(count)
        placed = np.zeros((len(targets), blocks * size // self.stride))
        placed[:, : targets.shape[1]] = targets
        sent = placed.reshape(len(targets), blocks, -1) @ _passed(self, size, order, lag).T
        found = np.zeros((len(targets), blocks + 1, size))
        found[:, :-1] += sent[:, :, :size]
        found[:, 1:] += sent[:, :, size:]
        return found.reshape(len(targets), -1)[:, :count]

    def _rows(self, count: int) -> int:
        """Rows that so many samples leave."""
        return len(range(self.margin, count - self.margin, self.stride))

    def _layout(self, count: int) -> tuple[int, int]:
        """Samples of a block, two of which give its rows, and how many blocks so many samples have."""
        size = self.stride * -(-(2 * self.margin + 1) // self.stride)
        return size, -(-self._rows(count) * self.stride // size)


@lru_cache(maxsize=16)
def _passed(smooth: GaussianFilter, size: int, order: int, lag: float) -> Array:
    """What each row of a block of so many samples has of those of it and of the next (2*size, rows)."""
    kernel = _kernel(smooth, order) + lag * _kernel(smooth, order + 1) if lag else _kernel(smooth, order)
    rows = size // smooth.stride
    shifted = np.zeros((rows, 2 * size + smooth.stride))
    shifted[:, : kernel.size] = kernel
    return shifted.ravel()[: rows * 2 * size].reshape(rows, 2 * size).T


@lru_cache(maxsize=64)
def _kernel(smooth: GaussianFilter, order: int) -> Array:
    """Weights of the samples around one (2*margin + 1,) in its filtered derivative - 1/s**order."""
    time = smooth.sample_period * np.arange(-smooth.margin, smooth.margin + 1)
    weight = np.exp(-0.5 * (time / smooth.width) ** 2)
    powers = (time[:, None] / smooth.width) ** np.arange(order + 1)
    orthogonal, scale = np.linalg.qr(powers * np.sqrt(weight)[:, None])
    kernel = np.sqrt(weight) * orthogonal[:, -1] / scale[-1, -1]
    return math.factorial(order) / smooth.width**order * kernel
