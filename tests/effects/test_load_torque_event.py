"""A torque that acts for a while changes speed by its impulse."""

import numpy as np

from tests.effects.axes import FREE, Present, moved, signals


def test_impulse():
    event = Present.of("load_torque_event", {"torque": 0.2, "start": 0.05, "end": 0.1})
    time, _, velocity = signals(moved([event], 0.2))
    np.testing.assert_allclose(velocity, -0.2 / FREE.inertia * np.clip(time - 0.05, 0.0, 0.05), atol=1e-6)
