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
