"""A filtered velocity lags a ramp by its time constant."""

import numpy as np

from bench.effects.velocity_filter_lag import EFFECT
from tests.effects.axes import PERIOD

VALUES = {"time_constant": 2e-3}


def test_lags_a_ramp():
    time = PERIOD * np.arange(400)
    found = EFFECT.filtered(VALUES, 100.0 * time, PERIOD)
    np.testing.assert_allclose(found, 100.0 * (time - 2e-3 * (1.0 - np.exp(-time / 2e-3))), atol=1e-9)


def test_undone_where_velocity_is_smooth():
    time = PERIOD * np.arange(4000)
    velocity = 50.0 * np.sin(2.0 * np.pi * 5.0 * time)
    back = EFFECT.unfiltered(VALUES, EFFECT.filtered(VALUES, velocity, PERIOD), PERIOD)
    np.testing.assert_allclose(back[100:-1], velocity[100:-1], atol=0.01)
