"""A filtered velocity lags a ramp by its time constant."""

from itertools import pairwise

import numpy as np

from bench.effects.velocity_filter_lag import EFFECT
from tests.effects.axes import PERIOD

VALUES = {"time_constant": 2e-3}


def test_lags_a_ramp():
    time = PERIOD * np.arange(400)
    found = EFFECT.filtered_along(VALUES, 100.0 * time, PERIOD)
    np.testing.assert_allclose(found, 100.0 * (time - 2e-3 * (1.0 - np.exp(-time / 2e-3))), atol=1e-9)


def test_along_a_recording_as_step_by_step():
    velocity = np.random.default_rng(0).normal(size=200)
    reported, found = velocity[:1], [velocity[0]]
    for before, now in pairwise(velocity):
        reported = EFFECT.filtered(VALUES, np.array([before]), np.array([now]), reported, PERIOD)
        found.append(reported[0])
    np.testing.assert_allclose(EFFECT.filtered_along(VALUES, velocity, PERIOD), found, atol=1e-12)


def test_undone_where_velocity_is_smooth():
    time = PERIOD * np.arange(4000)
    velocity = 50.0 * np.sin(2.0 * np.pi * 5.0 * time)
    back = EFFECT.unfiltered_along(VALUES, EFFECT.filtered_along(VALUES, velocity, PERIOD), PERIOD)
    np.testing.assert_allclose(back[100:-1], velocity[100:-1], atol=0.01)
