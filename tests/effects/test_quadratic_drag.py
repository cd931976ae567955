"""Drag slows a free axis down as 1/(1 + t/T)."""

import numpy as np

from tests.effects.axes import FREE, moved, present, signals


def test_coast_down():
    time, _, velocity = signals(moved([present("quadratic_drag")], 2.0, velocity=150.0))
    exact = 150.0 / (1.0 + 1.5e-5 * 150.0 * time / FREE.inertia)
    # drag acts with the speed at the start of the step: half a step of its own decay early
    assert np.abs(velocity - exact).max() < 0.02
