"""A constant torque accelerates a free axis evenly."""

import numpy as np

from tests.effects.axes import FREE, moved, present, signals


def test_free_axis_accelerates_evenly():
    time, position, velocity = signals(moved([present("torque_offset")], 0.2))
    np.testing.assert_allclose(velocity, 0.12 * time / FREE.inertia, atol=1e-9)
    np.testing.assert_allclose(position, 0.06 * time**2 / FREE.inertia, atol=1e-9)
