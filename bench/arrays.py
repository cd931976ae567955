"""Arrays of numbers, and functions of them used everywhere."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from statistics import NormalDist
from types import SimpleNamespace
from typing import Any

import array_api_compat
import numpy as np
from numpy.typing import NDArray

#: Numbers of any shape; a docstring gives it.
Array = NDArray[np.float64]
#: Those of any library of the array API standard, which have no static type in common.
Anys = Any
#: Half width of a normal distribution's 95 % interval in standard deviations.
NORMAL95 = NormalDist().inv_cdf(0.975)

#: The functions of formulas for numbers, of which a tick of a lone axis needs many: a tenth of the time of NumPy's.
NUMBERS = SimpleNamespace(
    inf=math.inf,
    abs=abs,
    clip=lambda value, low, high: min(max(value, low), math.inf if high is None else high),
    copysign=math.copysign,
    cos=math.cos,
    exp=math.exp,
    floor=math.floor,
    log=math.log,
    maximum=max,
    minimum=min,
    sin=math.sin,
    where=lambda condition, one, other: one if condition else other,
)


def namespace(value: object) -> Anys:
    """The functions of the array API standard for a value, those of NUMBERS for a number; TypeError if it is neither.

    Those of NumPy's own arrays are NumPy's.
    """
    kind = type(value)
    if kind is float or kind is np.float64:
        return NUMBERS
    return np if kind is np.ndarray else array_api_compat.array_namespace(value)


def made_like(array: Anys) -> Callable[[Anys], Anys]:
    """What makes numbers and arrays of NumPy's those of an array's library, on its device, of its precision."""
    xp = namespace(array)
    if xp is np:
        return lambda values: values
    device = array_api_compat.device(array)

    def made(values: Anys) -> Anys:
        host = np.asarray(values)
        return xp.asarray(host, dtype=array.dtype if host.dtype.kind == "f" else None, device=device)

    return made


def rms(values: Array) -> float:
    """Root mean square of all values, of any shape, in their unit."""
    return float(np.sqrt(np.mean(values**2)))


def known_rms(values: NDArray[np.floating]) -> float:
    """Root mean square of the finite ones of the values, of any shape, in their unit; nan where none is."""
    known = values[np.isfinite(values)].astype(np.float64)
    return rms(known) if known.size else np.nan


def correlation(one: Array, other: Array) -> float:
    """Pearson's correlation coefficient of two signals (n,); 0 where one of them never changes."""
    one, other = one - one.mean(), other - other.mean()
    return float(one @ other) / max(float(np.sqrt((one @ one) * (other @ other))), 1e-300)


def hann(length: int) -> Array:
    """Hann's window (length,), periodic."""
    return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)


def spectra(values: Array, window: Array) -> NDArray[np.complex128]:
    """Spectra of half-overlapping windows of a signal (n,), each less its mean - (windows, length // 2 + 1).

    P. D. Welch, IEEE Transactions on Audio and Electroacoustics 15(2), 1967, 70-73; what averages them here is at hand
    in `scipy.signal` too, which takes 0.3 to 0.6 s to import.
    """
    pieces = np.lib.stride_tricks.sliding_window_view(values, window.size)[:: window.size - window.size // 2]
    return np.fft.rfft((pieces - pieces.mean(axis=1, keepdims=True)) * window, axis=1)


def all_finite(values: Array) -> bool:
    """Whether no value is infinite or nan; costs no temporary array where none is."""
    with np.errstate(over="ignore", invalid="ignore"):
        # a sum is finite only if every term is; that of large finite ones may overflow, hence the second look
        return bool(np.isfinite(values.sum()) or np.isfinite(values).all())


def column_rms(table: Array) -> Array:
    """Root mean square of each column (m,) of a table (n, m), in its unit."""
    return np.sqrt(np.mean(table**2, axis=0))


def symmetric_inverse(matrix: Array, least: float) -> Array:
    """Pseudo-inverse of symmetric matrices (..., p, p), as `numpy.linalg.pinv` has it, which takes twice as long.

    Eigenvalues count as zero up to a share `least` of the largest one's magnitude. The unit is one over the matrix'.
    """
    values, vectors = np.linalg.eigh(matrix)
    magnitude = np.abs(values)
    kept = magnitude > least * magnitude.max(axis=-1, keepdims=True, initial=0.0)
    inverse = np.divide(1.0, values, out=np.zeros_like(values), where=kept)
    return (vectors * inverse[..., None, :]) @ vectors.swapaxes(-1, -2)


def recurrence(kept: Array, added: Array) -> Array:
    """y[k] = kept[k]*y[k - 1] + added[k] (n,) that begins at zero: a triangular system of two bands."""
    bands = np.ones((2, kept.size), order="F")
    bands[1, :-1] = -kept[1:]
    return _unit_lower_solve(bands, added)


def recursive_filter(
    numerator: Array | Sequence[float], denominator: Array | Sequence[float], values: Array, held: float = 0.0
) -> Array:
    """Values (n,) through a rational filter: sum of denominator[k]*y[t - k] = sum of numerator[k]*values[t - k].

    As `scipy.signal.lfilter` has it, which takes 0.6 s to import: here y solves a banded triangular system.

    Args:
        numerator: of the filter, in rising powers of the delay.
        denominator: the same; its first is 1.
        values: (n,), any unit.
        held: by the filter before the first value, which it adds to the first of y - the same unit.
    """
    driven = np.convolve(values, numerator)[: values.size]
    driven[0] += held
    bands = np.tile(np.asarray(denominator, dtype=np.float64), (values.size, 1)).T  # in Fortran's order, as BLAS has it
    return _unit_lower_solve(bands, driven)


def _unit_lower_solve(bands: Array, driven: Array) -> Array:
    """Solution (n,) of a lower triangular system by its bands (b, n), the diagonal, which is 1, first."""
    from scipy.linalg import get_blas_funcs  # 0.1 s, which only a filter has to pay

    (solve,) = get_blas_funcs(("tbsv",), dtype=np.float64)
    return solve(len(bands) - 1, bands, driven, lower=1, diag=1)


def spline(values: Array) -> Array:
    """Coefficients (4, n - 1) of a cubic spline through samples (n,), four at least, by powers of shares of a sample.

    As `scipy.interpolate.CubicSpline` has it, which takes 0.2 s to import: its third derivative runs straight through
    the second and the last but one sample.
    """
    from scipy.linalg import solve_banded  # 0.1 s, which only a spline has to pay

    rise = np.diff(values)
    bands, driven = np.ones((3, values.size)), np.empty(values.size)
    bands[1, 1:-1], driven[1:-1] = 4.0, 3.0 * (rise[1:] + rise[:-1])
    bands[0, 1], driven[0] = 2.0, 2.5 * rise[0] + 0.5 * rise[1]
    bands[2, -2], driven[-1] = 2.0, 2.5 * rise[-1] + 0.5 * rise[-2]
    slope = solve_banded((1, 1), bands, driven)
    bend, twist = 3.0 * rise - 2.0 * slope[:-1] - slope[1:], slope[:-1] + slope[1:] - 2.0 * rise
    return np.stack([values[:-1], slope[:-1], bend, twist])


def splined(values: Array, steps: int) -> tuple[Array, Array]:
    """A cubic spline through samples (n,) and its slope per sample, at `steps` to each: both ((n - 1)*steps + 1,)."""
    start, slope, bend, twist = spline(values)[:, :, None]
    at = np.arange(steps) / steps
    between = start + at * (slope + at * (bend + at * twist))
    slopes = slope + at * (2.0 * bend + 3.0 * at * twist)
    last = slope[-1] + 2.0 * bend[-1] + 3.0 * twist[-1]
    return np.append(between.ravel(), values[-1]), np.append(slopes.ravel(), last)
