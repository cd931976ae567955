"""Torque that follows the reported current: a step response."""

import numpy as np

from bench.effects.current_loop_lag import EFFECT
from tests.effects.axes import FREE, PERIOD, moved, present, signals


def test_step_response():
    states = moved([present("current_loop_lag")], 0.05, torque=0.5)
    time, _, velocity = signals(states)
    exact = 0.5 / FREE.inertia * (time - 2e-3 * (1.0 - np.exp(-time / 2e-3)))
    np.testing.assert_allclose(velocity, exact, atol=2e-4 * exact.max())
    np.testing.assert_array_equal(states.torque[:-1], 0.5)


def test_along_a_recording_as_step_by_step():
    reported = np.random.default_rng(0).normal(size=200)
    values = {"time_constant": 3e-3}
    before, middles = reported[:1], []
    for value in reported:
        middle, before = EFFECT.acting(values, np.array([value]), before, PERIOD)
        middles.append(middle[0])
    np.testing.assert_allclose(EFFECT.acting_along(values, reported, PERIOD), middles, atol=1e-12)
