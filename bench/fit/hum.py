"""Mains pick-up: sharp lines at multiples of 50 or 60 Hz are interference of the sensors, not of the axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.fit.fit import Fit, fit
from bench.fit.rows import Rows

#: Lines of the two grids of the world - Hz, and how far a grid strays - Hz.
LINES, STRAYS = (50.0, 60.0, 100.0, 120.0, 150.0, 180.0), 0.1
#: Band in which a line must stand out - Hz, and how many times above the band's median power; chance: 2**-20.
BAND, STANDS_OUT = 6.0, 20.0
#: Share of power that the filter must still pass.
PASSED = 0.01
#: Rate at which a residual is kept once its line is turned to zero frequency - Hz: the band's edge passes 0.95 of it.
RATE = 8.0 * BAND


def with_hum(fitted: Fit) -> Fit:
    """The fit with the lines of the mains that its residual shows taken into the hypothesis."""
    found = mains(fitted.rows, fitted.residual, fitted.hypothesis.hum)
    if len(found) == len(fitted.hypothesis.hum):
        return fitted
    return fit(fitted.rows, replace(fitted.hypothesis, hum=found))


def mains(rows: Rows, residual: Array, known: tuple[float, ...] = ()) -> tuple[float, ...]:
    """Lines of the mains that are known, and those that a residual (m,) of the used rows shows in addition - Hz."""
    width, duration, found = rows.conditioning.filter.width, rows.scope.duration, list(known)
    edges = np.searchsorted(rows.time, rows.starts[1:])
    pairs = zip(np.split(rows.time, edges), np.split(residual, edges), strict=True)
    recordings = [_Turned(time, left) for time, left in pairs if time.size]
    for line in LINES:
        if any(abs(line - other) < 1.0 for other in found) or not passes(line, width):
            continue
        offsets, power = _around(recordings, line)
        step = 0.5 / duration
        near, clear = np.abs(offsets) <= max(STRAYS, step), np.abs(offsets) > 4.0 * step
        if np.count_nonzero(clear) < 16:
            continue
        best = int(np.argmax(power))
        if near[best] and power[best] > STANDS_OUT * np.median(power[clear]):
            found.append(float(line + offsets[best]))
    return tuple(found)


def passes(line: float, width: float) -> bool:
    """Whether a filter of a width - s - lets a line - Hz - be seen."""
    return bool(np.exp(-((2.0 * np.pi * line * width) ** 2)) >= PASSED)


class _Turned:
    """A recording's residual turned to one frequency after another - m rows at uneven times."""

    def __init__(self, time: Array, residual: Array) -> None:
        self.time, self.residual = time, residual
        place = np.floor((time - time[0]) * RATE).astype(np.intp)
        self.first = np.flatnonzero(np.diff(place, prepend=-1))
        self.place = place[self.first]
        self.waves: dict[float, NDArray[np.complex128]] = {}

    def sums(self, line: float, count: int) -> NDArray[np.complex128]:
        """Sums over steps of time (count,) of the residual with a line - Hz - at zero frequency."""
        parts = next(((low, line - low) for low in self.waves if line - low in self.waves), None)
        if parts is None:
            self.waves[line] = np.exp(-2j * np.pi * line * self.time)
        else:  # a harmonic of lines that were asked for before, in a tenth of the time
            self.waves[line] = self.waves[parts[0]] * self.waves[parts[1]]
        sums = np.zeros(count, dtype=complex)
        sums[self.place] = np.add.reduceat(self.residual * self.waves[line], self.first)
        return sums


def _around(recordings: Sequence[_Turned], line: float) -> tuple[Array, Array]:
    """Offsets from a line within BAND - Hz - and the periodogram there, of rows at uneven times (m,) - s.

    The line is turned to zero frequency, where few sums over steps of time are to be transformed: a cost that grows
    with the recording's length, not with its square.
    """
    count = max(int((one.time[-1] - one.time[0]) * RATE) + 1 for one in recordings)
    power = np.zeros(2 * count)
    for one in recordings:
        power += np.abs(np.fft.fft(one.sums(line, count), 2 * count)) ** 2
    offsets = np.fft.fftfreq(2 * count, 1.0 / RATE)
    order = np.flatnonzero(np.abs(offsets) <= BAND)
    return np.asarray(offsets[order], dtype=np.float64), np.asarray(power[order], dtype=np.float64)
