"""Ripple under constant current: kinetic energy is the integral of torque over angle."""

import numpy as np

from tests.effects.axes import FREE, moved, present, signals


def test_work_of_the_motor():
    _, q, velocity = signals(moved([present("torque_ripple")], 0.3, torque=0.3))
    work = 0.3 * (q + 0.15 / 4.0 * (np.cos(-1.0) - np.cos(4.0 * q - 1.0)))
    np.testing.assert_allclose(0.5 * FREE.inertia * velocity**2, work, atol=2e-4 * work.max())


def test_no_current_no_ripple():
    _, _, velocity = signals(moved([present("torque_ripple")], 0.3, velocity=20.0))
    np.testing.assert_allclose(velocity, 20.0, atol=1e-9)
