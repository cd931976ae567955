"""The corner of a run-up: where voltage begins to limit the current."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.errors import UndeterminedError

#: Stretch of the falling current, in shares of its top, that the line is fitted to.
FROM, TO = 0.9, 0.5
#: Faster samples, as a share of the highest speed, may belong to the drive's own stop at the speed asked for.
STILL_RISING = 0.97
#: The top is the mean of samples above this share of the largest.
TOP = 0.95


def corner_speed(velocity: Array, current: Array) -> float:
    """Speed at which the line through the falling current meets the current's top - rad/s.

    In the circuit U = R*Iq + Ke*omega at full voltage, current falls linearly with speed, so the line is the physics
    and the corner that of the datasheet's curve. (Torque does not: kT rises as the current falls.)

    Args:
        velocity, current: (n,) of one run-up - rad/s, A.

    Raises:
        UndeterminedError: the current does not fall to half while the axis accelerates.
    """
    largest = float(current.max())
    high = np.flatnonzero(current > TOP * largest)
    falling = np.arange(current.size) > high[-1]
    falling &= (current < FROM * largest) & (current > TO * largest) & (velocity < STILL_RISING * velocity.max())
    speeds = velocity[falling]
    if speeds.size < 3 or np.ptp(speeds) <= 0.0:
        reason = "the current does not fall from its top to half of it as speed rises"
        raise UndeterminedError("corner speed", reason, "a run-up with full torque to close to the no-load speed")
    slope, offset = np.polyfit(speeds, current[falling], 1)
    first = high[0]
    top = float(np.median(current[first : high[-1] + 1]))
    return float((top - offset) / slope)
