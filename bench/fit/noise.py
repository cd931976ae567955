"""Noise floor of a fit: what the sensors' noise leaves in the residual, its colour read from the residual itself.

White noise of effort and speed passes filter and model with a known spectrum. Real noise need not be white: below
the frequencies at which its level was read it may stand higher. The residual tells by how much where it is quietest
- noise is there at every moment and every frequency, what a model lacks comes and goes with the motion - so the
lowest tenth over windows of time is taken at each frequency, and a first-order spectrum is laid through.

    S(omega) = S_white(omega)*(1 + c/(1 + (omega/omega_c)**2))
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.axis_kind import INERTIA, MISALIGNMENT, VISCOUS
from bench.effects.effect import Coupling
from bench.fit.hypothesis import Hypothesis
from bench.fit.layout import Layout, delays, effort_lag
from bench.fit.rows import Rows

#: Rows of a window, longer ones first, and windows of a length that it takes; else white noise is assumed.
LENGTHS, ENOUGH = (128, 64), 24
#: Lowest bin clear of the window's own leakage, and share of the strongest density below which a bin is not read.
LOWEST, HEARD = 3, 0.03
#: Power of a line in Hann's window, at its bin and the next.
HANN = np.array([1.0, 4.0, 1.0]) / 6.0
#: Quantile over windows that counts as quiet. Of noise every quantile tells the same level; of a lag's residual at
#: 4 ms a bin of the lower quartile still held 600 times the noise, of the lowest tenth 6 to 12 times.
QUIET = 0.1
#: Excess at low frequency that chance makes in a white recording, and that is therefore not called colour.
CHANCE = 0.4
#: Excesses tried, and corners, from the lowest frequency read to this many times the highest.
EXCESSES = np.r_[0.0, np.geomspace(CHANCE, 1e4, 60)]
CORNERS, BEYOND = 16, 3.0
#: Power of noise in the torque balance - (N*m)**2 (N**2) - over angular frequency - rad/s -, for the power there of the
#: noise of the signal that speed is taken from.
Power = Callable[[Array, Array], Array]


@dataclass(frozen=True, eq=False)
class Floor:
    """RMS of noise in a residual.

    Attributes:
        rows: the recording.
        power: of noise in the torque balance before the filter.
        residual: (m,) of the used rows - N*m (N).
        rounded: RMS of what rounding of the effort leaves beside - N*m (N).
    """

    rows: Rows
    power: Power
    residual: Array
    rounded: float = 0.0

    @cached_property
    def white(self) -> float:
        """Of its white part alone - N*m (N)."""
        return math.hypot(self._rms(self._lines(self._omega)), self.rounded)

    @cached_property
    def coloured(self) -> float:
        """Of all of it - N*m (N)."""
        excess, corner = colour(self.rows, self._white, self._lines, self.residual)
        if not excess:
            return self.white
        omega = self._omega
        more = self._white(omega) * excess / (1.0 + (omega / corner) ** 2)
        return math.hypot(self._rms(self._lines(omega) + more), self.rounded)

    @property
    def _omega(self) -> Array:
        return np.linspace(0.0, np.pi / self.rows.conditioning.filter.sample_period, 2048)

    def _rms(self, spectrum: Array) -> float:
        period = self.rows.conditioning.filter.sample_period
        return float(np.sqrt(period / np.pi * np.trapezoid(spectrum, self._omega)))

    def _white(self, omega: Array) -> Array:
        """Density of white noise behind the filter."""
        return self._density(omega, np.full(omega.size, self.rows.conditioning.source_noise**2))

    def _lines(self, omega: Array) -> Array:
        """The same with what rounding leaves."""
        return self._density(omega, self.rows.conditioning.source_power(omega))

    def _density(self, omega: Array, source: Array) -> Array:
        return np.exp(-((omega * self.rows.conditioning.filter.width) ** 2)) * self.power(omega, source)


def noise_power(rows: Rows, hypothesis: Hypothesis, layout: Layout, theta: Array) -> Power:
    """Power of noise of effort and speed in the torque balance, over angular frequency.

    s_M**2*|(1 + tau*s)*(1 + T*s)|**2 + s_w**2*|(J*s + K_w)*(1 + lag*s) + ...|**2 + s_p**2*|s*(1 + lag*s)|**2

    and twice what the known momentum p has of the speed's own noise: the joint's inertia where the arm is, less that
    where the MJCF stands.
    """
    conditioning = rows.conditioning
    moving, _ = delays(rows, hypothesis)
    inertia, viscous, shift = (float(theta[layout.owners == name][0]) for name in (INERTIA, VISCOUS, MISALIGNMENT))

    def power(omega: Array, source: Array) -> Array:
        s = 1j * omega
        kinetic = inertia * s + viscous
        for index, term in enumerate(hypothesis.terms):
            if isinstance(term.effect, Coupling):
                transfer = term.effect.noise_of_motion(term.shape, omega)
                kinetic = kinetic + theta[layout.owners == index][0] * s * transfer
        kinetic = kinetic * (1.0 + moving * s) * (s if conditioning.source == "position" else 1.0)
        late = (1.0 + shift * s) * (1.0 + effort_lag(hypothesis) * s)
        effort = conditioning.effort_noise**2 * _square(late)
        rate = (1.0 + moving * s) * s
        both = 2.0 * conditioning.known_shared * (kinetic * rate.conj()).real
        known = conditioning.known_noise**2 * _square(rate)
        return effort + np.maximum(known + both + source * _square(kinetic), 0.0)

    return power


def _square(values: NDArray[np.complex128]) -> Array:
    """Squared magnitudes, whose root NumPy would draw first."""
    return values.real**2 + values.imag**2


def colour(
    rows: Rows, density: Callable[[Array], Array], lines: Callable[[Array], Array], residual: Array
) -> tuple[float, float]:
    """Excess c at low frequency over white noise, and its corner omega_c - rad/s; (0, 1) where the noise is white.

    `lines` adds to the density of white noise what rounding leaves. Such lines come and go with the speed, and stay
    with a steady one: neither is colour.
    """
    windows = _windows(rows, residual)
    count, length = windows.shape
    smooth = rows.conditioning.filter
    period = smooth.stride * smooth.sample_period
    omega = np.pi / period * np.arange(length // 2 + 1) / max(length // 2, 1)
    white = density(omega) / smooth.stride
    read = np.flatnonzero(white > HEARD * white.max())
    read = read[read >= LOWEST]
    if not count or read.size < LOWEST:
        return 0.0, 1.0
    taper = np.hanning(length)
    spectra = np.abs(np.fft.rfft(windows * taper, axis=1)[:, read]) ** 2 / np.sum(taper**2)
    known = np.maximum(white, np.convolve(lines(omega), HANN, "same") / smooth.stride)[read]
    ratio = np.quantile(spectra, QUIET, axis=0) / _quiet_level(count) / known
    corners, levels = _levels(tuple(read.tolist()))
    misfit = np.sum(np.abs(levels - np.log(ratio)), axis=2)  # a sharp line sways a sum of magnitudes little
    excess, corner = np.unravel_index(int(np.argmin(misfit)), misfit.shape)
    return float(EXCESSES[excess]), float(corners[corner] * omega[1])


@lru_cache(maxsize=8)
def _levels(read: tuple[int, ...]) -> tuple[Array, Array]:
    """Corners tried (c,) in bins, and by each excess and corner the logarithm of the colour at bins (e, c, bins)."""
    corners = np.geomspace(read[0], BEYOND * read[-1], CORNERS)
    shapes = 1.0 / (1.0 + (np.array(read) / corners[:, None]) ** 2)
    return corners, np.log1p(EXCESSES[:, None, None] * shapes)


def _quiet_level(count: int) -> float:
    """What the quiet quantile of `count` exponential variables is to their mean, from expected order statistics."""
    expected = np.cumsum(1.0 / np.arange(count, 0, -1))
    return float(np.interp(QUIET * (count - 1), np.arange(count), expected))


def _windows(rows: Rows, residual: Array) -> Array:
    """Half-overlapping windows of neighbouring rows, each less its straight line (k, length); none where too few."""
    used = tuple(part.used.tobytes() for part in rows.stretches)
    for length in LENGTHS:
        starts = _starts(used, length)
        if starts.size >= ENOUGH:
            found = residual[starts[:, None] + np.arange(length)]
            ramp = np.linspace(-1.0, 1.0, length)
            return found - found.mean(axis=1, keepdims=True) - np.outer(found @ ramp / (ramp @ ramp), ramp)
    return np.empty((0, LENGTHS[-1]))


@lru_cache(maxsize=8)
def _starts(used: tuple[bytes, ...], length: int) -> NDArray[np.int64]:
    """First rows of the windows that span no gap."""
    found, offset = [], 0
    for raw in used:
        rows = np.flatnonzero(np.frombuffer(raw, dtype=bool))
        runs = np.split(np.arange(rows.size), np.flatnonzero(np.diff(rows) != 1) + 1)
        found += [offset + np.arange(run[0], run[-1] - length + 2, length // 2) for run in runs if run.size >= length]
        offset += rows.size
    return np.concatenate(found) if found else np.empty(0, dtype=np.int64)
