"""An eccentric encoder: velocity is the derivative of position, and both can be undone."""

import numpy as np

from bench.effects.encoder_eccentricity import EFFECT
from tests.effects.axes import PERIOD

VALUES = {"amplitude": 0.05, "phase": 0.9}


def test_velocity_is_the_derivative_of_position():
    time = PERIOD * np.arange(4000)
    position, velocity = EFFECT.seen(VALUES, 20.0 * time, np.full_like(time, 20.0))
    np.testing.assert_allclose(np.gradient(position, PERIOD)[1:-1], velocity[1:-1], atol=1e-4)
    assert np.ptp(velocity) > 1.9


def test_undone():
    position, velocity = np.linspace(-20.0, 20.0, 500), np.linspace(5.0, -5.0, 500)
    back = EFFECT.unseen(VALUES, *EFFECT.seen(VALUES, position, velocity))
    np.testing.assert_allclose(back, (position, velocity), atol=1e-12)
