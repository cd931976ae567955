"""Curves over time as a page holds them: lowest and highest value of each interval, in 16 bits.

A page draws at most a few intervals per pixel, so what lies between lowest and highest of an interval would not show.
Signals of unlike rows (every sample, rows of a torque balance) come on one grid: one time axis for all.
"""

from __future__ import annotations

import base64
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.report.page.scripted import Samples

#: Numbers that a page holds of its graphs: FEW where samples are few, then MORE for each of them, at most MOST. A
#: number takes 2.7 bytes: that is 0.7 MB for 10 s at 1 kHz, and 3.7 MB for ten million samples.
FEW, MORE, MOST = 250_000, 5, 1_400_000
#: Steps between lowest and highest value, and what stands for no value.
STEPS, NOTHING = 65534, -32768


@dataclass(frozen=True)
class Grid:
    """Intervals of equal length.

    Attributes:
        start: of the first - s.
        step: of each - s.
        count: of them.
        single: whether an interval is a sample period, so that one value stands for it.
    """

    start: float
    step: float
    count: int
    single: bool

    @classmethod
    def of(cls, time: Array, curves: int, share: float = 1.0) -> Grid:
        """Grid for so many curves of a recording.

        Args:
            time: of its samples - s - (n,).
            curves: that a page shows over it.
            share: of what the page may hold that this recording may take.
        """
        most = share * min(max(FEW, MORE * time.size), MOST) / curves
        period = float(np.median(np.diff(time[: min(time.size, 10_000)])))
        span = float(time[-1] - time[0])
        samples = round(span / period) + 1
        if samples <= most:
            return cls(float(time[0]), period, samples, True)
        count = max(2, int(most / 2))
        return cls(float(time[0]), span / (count - 1), count, False)

    def places(self, time: Array) -> NDArray[np.int64]:
        """Interval of each time (n,)."""
        found = np.rint((time - self.start) / self.step).astype(np.int64)
        return np.clip(found, 0, self.count - 1)

    def samples(self, places: NDArray[np.int64], values: NDArray[np.floating]) -> Samples:
        """A curve on the grid: values (n,) at ascending places (n,); nan is a hole."""
        known = np.isfinite(values)
        places, values = (places, values) if known.all() else (places[known], values[known])
        low, high = np.full(self.count, np.nan), np.full(self.count, np.nan)
        if values.size:
            first = np.flatnonzero(np.diff(places, prepend=-1))
            low[places[first]] = np.minimum.reduceat(values, first)
            high[places[first]] = np.maximum.reduceat(values, first)
        least, most = (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
        middle, scale = 0.5 * (least + most), (most - least) / STEPS or 1.0
        return Samples(
            offset=middle,
            scale=scale,
            low=_packed(low if not self.single else 0.5 * (low + high), middle, scale),
            high=None if self.single else _packed(high, middle, scale),
        )


def _packed(values: Array, middle: float, scale: float) -> str:
    """16-bit steps from the middle of the range, little endian, in base 64."""
    steps = np.clip(np.rint((values - middle) / scale), -STEPS // 2, STEPS // 2)
    return base64.b64encode(np.where(np.isnan(steps), NOTHING, steps).astype("<i2").tobytes()).decode("ascii")


def unpacked(samples: Samples) -> tuple[Array, Array]:
    """Lowest and highest value of each interval (count,), nan where there is none."""
    found = []
    for text in (samples.low, samples.high or samples.low):
        steps = np.frombuffer(base64.b64decode(text), dtype="<i2").astype(np.float64)
        found.append(np.where(steps == NOTHING, math.nan, samples.offset + samples.scale * steps))
    return found[0], found[1]
