"""Torque that is known to act on an axis beside its own inertia and friction: what the rest of a robot asks of it.

    M_known = r + dp/dt

r - torque of all but accelerations - N*m (N); p - momentum, whose rate is the torque of accelerations - N*m*s (N*s).
Parted so, no acceleration has to be had from the samples: the balance's own filter takes the rate.
"""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.trace.filter import Column
from bench.trace.signals import KNOWN_MOMENTUM, KNOWN_TORQUE
from bench.trace.trace import Trace


def with_known(trace: Trace, torque: Array, momentum: Array, unit: str) -> Trace:
    """A recording with what is known to act - unit, unit*s - (n,) each."""
    signals = {KNOWN_TORQUE: torque, KNOWN_MOMENTUM: momentum}
    return trace.with_signals(signals, {KNOWN_TORQUE: unit, KNOWN_MOMENTUM: f"{unit}*s"})


def known_column(trace: Trace, part: slice) -> Column:
    """The torque that is known along a stretch, as a column of the torque balance; () where none is."""
    if KNOWN_TORQUE not in trace:
        return ()
    return (trace[KNOWN_TORQUE][part], 0), (trace[KNOWN_MOMENTUM][part], 1)


def less_known(trace: Trace, effort: Array) -> Array:
    """An effort less the torque that is known, sample by sample with the noise that has - (n,)."""
    if KNOWN_TORQUE not in trace:
        return effort
    rate = np.zeros(len(trace))
    for part in trace.segments:
        if part.stop - part.start > 1:
            rate[part] = np.gradient(trace[KNOWN_MOMENTUM][part], trace.sample_period)
    return effort - trace[KNOWN_TORQUE] - rate
