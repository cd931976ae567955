"""Motion: angle, speed, acceleration and effort of a recording, all through one zero-phase filter."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.trace.conditioning import Conditioning, known_sign, raw_speed
from bench.trace.trace import Trace

#: Samples filtered at once, margins included: long enough that these cost little, short enough for the cache.
BLOCK = 2**15
#: A filtered sign further than this from +-1 has seen speeds of the other sign, or of none.
ONE_SIGN = 1e-3


@dataclass(frozen=True)
class Motion:
    """Filtered columns of one recording, rows without a hole in reach of the filter; all arrays (m,).

    Attributes:
        time: s.
        velocity: omega - rad/s (m/s).
        acceleration: alpha - rad/s**2 (m/s**2).
        effort: motor torque M - N*m (force - N, or what the rig allows).
        effort_rate: dM/dt - effort's unit per s.
        direction: filtered sgn(omega), within ONE_SIGN of +-1; 0 where the filter's reach holds both signs or none.
        conditioning: how it was filtered.
    """

    time: Array
    velocity: Array
    acceleration: Array
    effort: Array
    effort_rate: Array
    direction: Array
    conditioning: Conditioning

    def __len__(self) -> int:
        return self.time.size


def motion(trace: Trace, effort: Array, conditioning: Conditioning) -> Motion:
    """Filter a recording; stretches shorter than the filter's two margins are left out."""
    parts = [_filtered(trace, effort, conditioning, block) for block in _blocks(trace, conditioning)]
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)] if parts else [np.empty(0)] * 6
    return Motion(*columns, conditioning=conditioning)


def _blocks(trace: Trace, conditioning: Conditioning) -> Iterator[slice]:
    """Blocks of each segment, overlapping by two margins so that their rows join without a gap."""
    margin = conditioning.filter.margin
    step = BLOCK - 2 * margin if 4 * margin < BLOCK else BLOCK
    for segment in trace.segments:
        for start in range(segment.start, segment.stop - 2 * margin, step):
            yield slice(start, min(start + step + 2 * margin, segment.stop))


def _filtered(trace: Trace, effort: Array, conditioning: Conditioning, block: slice) -> tuple[Array, ...]:
    """Columns of one block: products and signs are formed on raw samples and filtered afterwards."""
    smooth, order = conditioning.filter, conditioning.order
    source = trace[conditioning.source][block]
    speed = raw_speed(source, conditioning.source, trace.sample_period)
    sign = known_sign(speed, conditioning.sign_threshold)
    torque = effort[block]
    made = ((source, order), (source, order + 1), (torque, 0), (torque, 1), (sign, 0))
    rows = smooth.columns([[term] for term in made])
    velocity, acceleration, torque, rate, direction = rows
    direction[np.abs(direction) < 1.0 - ONE_SIGN] = 0.0
    time = trace.time[block][smooth.margin : (block.stop - block.start) - smooth.margin : smooth.stride]
    return time, velocity, acceleration, torque, rate, direction
