"""Stretches of a recording that stand for all of it, so that a check costs the same for an hour as for a minute."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bench.arrays import Array
from bench.trace.conditioning import raw_speed
from bench.trace.trace import Trace

#: Samples of a stretch, and stretches of a recording, evenly spaced where there are more.
LONGEST, MOST = 2**13, 4


def stretches(trace: Trace, least: int) -> Iterator[slice]:
    """Stretches without a hole of at least `least` samples: all, or evenly spaced ones of a long recording."""
    pieces = [
        slice(start, min(start + LONGEST, part.stop))
        for part in trace.segments
        for start in range(part.start, part.stop, LONGEST)
    ]
    if len(trace) > MOST * LONGEST:
        long = [piece for piece in pieces if 2 * (piece.stop - piece.start) > LONGEST] or pieces
        pieces = [long[k] for k in np.unique(np.linspace(0, len(long) - 1, MOST).astype(int))]
    return (piece for piece in pieces if piece.stop - piece.start >= least)


def speed_of(trace: Trace, part: slice) -> Array | None:
    """Speed over a stretch (n,) - rad/s (m/s): the reported one, else the position's; None where there is neither."""
    if "velocity" in trace:
        return trace["velocity"][part]
    return raw_speed(trace["position"][part], "position", trace.sample_period) if "position" in trace else None


def resolution_of(values: Array) -> float:
    """Smallest step between successive values (n,) that differ, in their unit; 0 where none do."""
    steps = np.abs(np.diff(values))
    return float(steps.min(where=steps > 0.0, initial=np.inf)) if steps.any() else 0.0
