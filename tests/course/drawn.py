"""What a task draws, as arrays."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Drawn:
    """A curve of a chart: points x, y (n,), and what it is called."""

    x: np.ndarray
    y: np.ndarray
    name: str


def curves(task, chart=0, panel=0):
    """Curves of one panel of one chart."""
    shown = task.charts[chart].panels[panel].series
    return [Drawn(np.array(one.x), np.array(one.y), one.name) for one in shown]


def extrapolated_corner(velocity, current):
    """Speed at which the line through the current from 0.9 to 0.5 of its top meets the top - rad/s."""
    largest = current.max()
    last = np.flatnonzero(current > 0.95 * largest)[-1]
    falling = np.arange(current.size) > last
    falling &= (current < 0.9 * largest) & (current > 0.5 * largest) & (velocity < 0.97 * velocity.max())
    slope, offset = np.polyfit(velocity[falling], current[falling], 1)
    return (np.median(current[current > 0.95 * largest]) - offset) / slope
