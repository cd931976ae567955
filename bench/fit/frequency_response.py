"""Frequency response of an axis: speed over torque, as the recording has it.

    H(f) = S_tv(f)/S_tt(f),  coherence g2(f) = |S_tv|**2/(S_tt*S_vv),  relative error of |H|: sqrt((1 - g2)/(2*g2*n))

S - spectra of torque t and speed v, averaged over n windows (Hann, half overlapping; of n half overlapping ones 0.53 to
0.66 count as independent, here 0.6). A motor with an elastic load resonates where the complex poles of

    H(s) = (b0 + b1*s + b2*s**2)/(a0 + a1*s + a2*s**2 + s**3)*exp(-s*T)

are, and resists most, the antiresonance, where its zeros are: for the load's inertia J_l behind a spring k at
sqrt(k/J_l). T - delay of the speed, half a period where the torque is held between samples. The coefficients are fitted
to H by iterated linear least squares, T by a search around them. The intervals count the errors of H, that neighbouring
lines of a Hann window share theirs, what the function does not fit, and half the distance of two lines.
Sources: J. S. Bendat, A. G. Piersol, Random Data, 4th ed., 2010, ch. 6 and 9; C. K. Sanathanan, J. Koerner, IEEE
Trans. Automatic Control 8 (1963) 56-58; P. D. Welch, IEEE Trans. Audio Electroacoustics 15 (1967) 70-73.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from bench.arrays import NORMAL95, Array
from bench.names import with_known_arguments
from bench.parameter import Parameter
from bench.presented import ByName
from bench.rig.given import Given, GivenRig, Units, recordings_of
from bench.trace.motion import measured_velocity

Complex = NDArray[np.complex128]

#: Windows that are averaged at least, and samples of one at least and at most.
WINDOWS, SHORTEST, LONGEST = 12, 128, 8192
#: Independent windows in a half overlapping one.
INDEPENDENT = 0.6
#: Coherence from which a frequency counts, and how many frequencies must.
COHERENT, FEWEST = 0.8, 16
#: Variance of a mean of neighbouring Hann-weighted lines over that of independent ones: 1 + 2*(2/3)**2 + 2*(1/6)**2.
CORRELATION = 35.0 / 18.0
#: Rounds of the fit, and damping ratio up to which a pair of poles or zeros is a resonance.
ROUNDS, RINGS = 12, 0.3
#: Largest delay that is sought - samples.
DELAY = 3.0
#: Largest relative half width of a frequency that is reported.
KNOWN = 0.1


@dataclass(frozen=True)
class FrequencyResponse(ByName):
    """Speed over torque at the frequencies that the recording excites.

    Attributes:
        frequency: Hz (k,).
        response: rad/s/(N*m) (m/s/N) (k,).
        coherence, error: of it, the latter the relative standard error of its size (k,).
        coherent: whether the coherence is high enough for the response to be reported (k,).
        windows: that were averaged.
        resonance, antiresonance: of an elastic load - Hz; None where the response shows none.
    """

    frequency: Array
    response: Complex
    coherence: Array
    error: Array
    coherent: NDArray[np.bool_]
    windows: int
    resonance: Parameter | None
    antiresonance: Parameter | None


@with_known_arguments
def frequency_response(
    trace: Given, rig: GivenRig | None = None, units: Units | None = None
) -> FrequencyResponse | None:
    """Of a recording; None where it is too short, or its torque excites too few frequencies above noise.

    Args:
        trace: the recording, its file, arrays by their names or a data frame.
        rig: what is known about the axis, as `bench.identify` takes it.
        units: of columns by their names.

    Raises:
        InputError: neither speed nor position, or nothing that drives the axis.
    """
    rig, (trace,) = recordings_of(trace, rig, units)
    effort, _ = rig.effort(trace)
    velocity = measured_velocity(trace)
    return response_of([(effort[part], velocity[part]) for part in trace.segments], trace.sample_period)


def response_of(stretches: list[tuple[Array, Array]], sample_period: float) -> FrequencyResponse | None:
    """The same of stretches of torque and speed, (n,) each, without a hole."""
    samples = sum(effort.size for effort, _ in stretches)
    length = min(LONGEST, 2 * samples // (WINDOWS + 1))
    if length < SHORTEST:
        return None
    cut = [_windows(np.stack(signals), length) for signals in stretches if signals[0].size >= length]
    if not cut or sum(part.shape[1] for part in cut) < WINDOWS // 2:
        return None
    torque, speed = np.concatenate(cut, axis=1)
    frequency = np.fft.rfftfreq(length, sample_period).astype(np.float64)
    spectra = np.stack([np.abs(torque) ** 2, np.abs(speed) ** 2]), torque.conj() * speed
    (drive, motion), cross = spectra[0].sum(axis=1), spectra[1].sum(axis=0)
    coherence = np.abs(cross) ** 2 / np.maximum(drive * motion, 1e-300)
    count = len(torque)
    error = np.sqrt((1.0 - coherence) / np.maximum(2.0 * coherence * INDEPENDENT * count, 1e-300))
    coherent = (coherence >= COHERENT) & (frequency > frequency[1])
    if np.count_nonzero(coherent) < FEWEST:
        return None
    whole = cross / np.maximum(drive, 1e-300)
    used = frequency[coherent], 1.0 / np.maximum(error[coherent], 1e-3)
    delay = scipy.optimize.minimize_scalar(
        lambda shift: _fitted(*used, whole[coherent], shift)[1], bounds=(-DELAY * sample_period, DELAY * sample_period)
    ).x
    pairs, spread = _pairs(*used, whole[coherent], delay)
    resonance, antiresonance = (
        _reported(value, std, frequency[coherent]) for value, std in zip(pairs, spread, strict=True)
    )
    return FrequencyResponse(frequency, whole, coherence, error, coherent, count, resonance, antiresonance)


def _windows(signals: Array, length: int) -> Complex:
    """Spectra (2, w, k) of half overlapping Hann windows of two signals (2, n), each less its line."""
    starts = range(0, signals.shape[1] - length + 1, length // 2)
    cut = np.stack([signals[:, start : start + length] for start in starts], axis=1)
    return np.fft.rfft(scipy.signal.detrend(cut) * np.hanning(length))


def _fitted(frequency: Array, weight: Array, response: Complex, delay: float) -> tuple[Array, float, Array]:
    """Coefficients (6,), b before a, of s over the highest frequency, the squared residual, and the covariance.

    frequency (k,) - Hz -, weight (k,): one over the relative error; delay - s.
    """
    s = 1j * frequency / frequency.max()
    h = response * np.exp(2j * np.pi * frequency * delay)
    columns = np.stack([np.ones_like(s), s, s**2, -h, -h * s, -h * s**2], axis=1)
    theta, below, rows, residual = np.zeros(6), np.ones_like(s), np.empty((0, 6)), np.empty(0)
    for _ in range(ROUNDS):  # each time over the denominator found before
        factor = (weight / np.abs(h) / np.abs(below))[:, None]
        rows, goal = columns * factor, (h * s**3)[:, None] * factor
        rows, goal = (np.concatenate([part.real, part.imag]) for part in (rows, goal))
        theta = np.linalg.lstsq(rows, goal[:, 0], rcond=None)[0]
        residual = rows @ theta - goal[:, 0]
        below = np.polyval([1.0, *theta[:2:-1]], s)
    squares = float(residual @ residual)
    misfit = max(squares / max(residual.size - 6, 1), 0.5)
    covariance = CORRELATION * misfit * np.linalg.pinv(rows.T @ rows)
    return theta.astype(np.float64), squares, covariance.astype(np.float64)


def _pairs(frequency: Array, weight: Array, response: Complex, delay: float) -> tuple[Array, Array]:
    """Frequencies of complex poles and zeros of the function fitted to a response, nan without, and their std - Hz."""
    highest = float(frequency.max())

    def pairs(theta: Array) -> Array:
        return highest * np.array([_ringing(np.append(1.0, theta[:2:-1])), _ringing(theta[2::-1])])

    theta, _, covariance = _fitted(frequency, weight, response, delay)
    steps = 1e-3 * np.sqrt(np.diag(covariance))
    slopes = np.stack([(pairs(theta + step) - pairs(theta)) / step.sum() for step in np.diag(steps)])
    return pairs(theta), np.sqrt(np.einsum("ij,ik,kj->j", slopes, covariance, slopes))


def _ringing(polynomial: Array) -> float:
    """Size of the complex root that decays least for its frequency; nan where none rings."""
    found = [
        root
        for root in np.roots(polynomial).astype(np.complex128)
        if root.imag > 0.0 and abs(root.real) < RINGS * abs(root)
    ]
    return float(abs(min(found, key=lambda root: abs(root.real) / abs(root)))) if found else math.nan


def _reported(value: float, std: float, coherent: Array) -> Parameter | None:
    """A frequency within the coherent ones, if its interval is narrow enough - Hz."""
    half = math.hypot(NORMAL95 * std, 0.5 * float(np.diff(coherent).min()))
    if not coherent.min() < value < coherent.max() or not half < KNOWN * value:
        return None
    return Parameter.around(value, "Hz", half / NORMAL95, half)
