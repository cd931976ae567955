"""A spring makes a free axis an oscillator."""

import numpy as np

from tests.effects.axes import FREE, moved, present, signals


def test_free_axis_swings():
    time, position, _ = signals(moved([present("torsion_spring")], 2.0, velocity=10.0))
    omega = np.sqrt(0.02 / FREE.inertia)
    np.testing.assert_allclose(position, 10.0 / omega * np.sin(omega * time), atol=1e-4)
