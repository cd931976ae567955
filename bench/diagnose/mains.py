"""Mains pick-up: sharp lines at multiples of 50 or 60 Hz are the sensors' hum, not the axis'."""

from __future__ import annotations

import numpy as np

from bench.diagnose.fit import Fit, fit
from bench.diagnose.workbench import Workbench

#: Lines of the two grids of the world - Hz, and how far a grid strays - Hz.
LINES, STRAYS = (50.0, 60.0, 100.0, 120.0, 150.0, 180.0), 0.1
#: Band in which a line must stand out - Hz, and how many times above the band's median power; chance: 2**-20.
BAND, STANDS_OUT = 6.0, 20.0
#: Share of power that the filter must still pass.
PASSED = 0.01


def humming(bench: Workbench, fitted: Fit) -> Fit:
    """The fit with the lines of the mains that its residual shows taken into the hypothesis."""
    time = bench.row_values(lambda s: s.time)
    smooth = bench.conditioning.filter
    step = 0.5 / bench.duration
    offsets = step * np.arange(-int(BAND / step), int(BAND / step) + 1)
    near, clear = np.abs(offsets) <= max(STRAYS, step), np.abs(offsets) > 4.0 * step
    found = list(fitted.hypothesis.mains)
    for line in LINES:
        known = any(abs(line - other) < 1.0 for other in found)
        if known or np.exp(-((2.0 * np.pi * line * smooth.width) ** 2)) < PASSED or np.count_nonzero(clear) < 16:
            continue
        power = _power(time, fitted.residual, line + offsets)
        best = int(np.argmax(power))
        if near[best] and power[best] > STANDS_OUT * np.median(power[clear]):
            found.append(float(line + offsets[best]))
    if len(found) == len(fitted.hypothesis.mains):
        return fitted
    return fit(bench, fitted.hypothesis.with_mains(tuple(found)))


def _power(time: np.ndarray, residual: np.ndarray, frequencies: np.ndarray) -> np.ndarray:
    """Periodogram of rows at uneven times, by the recurrence of equal steps in frequency."""
    turned = np.exp(-2j * np.pi * frequencies[0] * time) * residual
    step = np.exp(-2j * np.pi * (frequencies[1] - frequencies[0]) * time)
    power = np.empty(frequencies.size)
    for k in range(frequencies.size):
        power[k] = np.abs(turned.sum()) ** 2
        turned = turned * step
    return power
