"""A zero that drifts: the torque that is missing grows with time."""

import numpy as np

from tests.effects.axes import FREE, VALUES, moved, present, signals

NAME = "current_offset_drift"


def test_coasts_as_under_a_torque_that_grows():
    time, _, velocity = signals(moved([present(NAME)], 0.4))
    np.testing.assert_allclose(velocity, -0.5 * VALUES[NAME]["rate"] * time**2 / FREE.inertia, atol=1e-4)
