"""Known torque on an axis in addition to its inertia and friction, such as that of the rest of a robot.

    M_known = r + dp/dt

r - torque not due to acceleration - N*m (N); p - momentum, whose rate is the torque due to acceleration - N*m*s (N*s).
In this form no acceleration is needed: the filter of the torque balance differentiates the momentum.
"""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.trace.filter import Column
from bench.trace.signals import KNOWN_MOMENTUM, KNOWN_TORQUE
from bench.trace.trace import Trace


def with_known(trace: Trace, torque: Array, momentum: Array, unit: str) -> Trace:
    """A recording with known torque and momentum - unit, unit*s - (n,) each."""
    signals = {KNOWN_TORQUE: torque, KNOWN_MOMENTUM: momentum}
    return trace.with_signals(signals, {KNOWN_TORQUE: unit, KNOWN_MOMENTUM: f"{unit}*s"})


def known_column(trace: Trace, part: slice) -> Column:
    """Known torque along a stretch as a column of the torque balance; () if there is none."""
    if KNOWN_TORQUE not in trace:
        return ()
    return (trace[KNOWN_TORQUE][part], 0), (trace[KNOWN_MOMENTUM][part], 1)


def less_known(trace: Trace, effort: Array) -> Array:
    """An effort less the known torque, unfiltered - (n,)."""
    if KNOWN_TORQUE not in trace:
        return effort
    rate = np.zeros(len(trace))
    for part in trace.segments:
        if part.stop - part.start > 1:
            rate[part] = np.gradient(trace[KNOWN_MOMENTUM][part], trace.sample_period)
    return effort - trace[KNOWN_TORQUE] - rate
