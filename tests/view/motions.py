"""Motions in closed form to be shown: the model a little ahead of its ghost."""

import numpy as np

from bench.axis_kind import ROTARY
from bench.view.side_by_side import SideBySide

AHEAD, SPEED = 0.02, 3.0


def shown(kind=ROTARY, ghost_is="measured", duration=2.0, period=1e-3, hole=None):
    """A constant speed, the model ahead; no sample lies in the hole, from one time to another."""
    time = period * np.arange(round(duration / period) + 1)
    if hole is not None:
        time = time[(time < hole[0]) | (time > hole[1])]
    speed = np.full(time.size, SPEED)
    return SideBySide(kind, ghost_is, "It turns.", time, SPEED * time, SPEED * time + AHEAD, speed, speed)
