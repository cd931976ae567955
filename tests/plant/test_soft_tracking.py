"""A model held softly to a recording, against the closed form of its linear loop."""

import numpy as np
import pytest
from scipy.linalg import expm

from bench.plant.axis_model import AxisModel
from bench.plant.model import AxisParameters
from bench.plant.soft_tracking import Held, track
from bench.trace.trace import Trace

INERTIA, VISCOUS, PERIOD, BANDWIDTH = 2e-3, 3e-3, 1e-3, 12.0
TIME = PERIOD * np.arange(2000)
FREE = AxisModel(AxisParameters(INERTIA, VISCOUS))


def at_rest(position=0.0):
    still = np.zeros_like(TIME)
    return Trace(TIME, {"position": still + position, "velocity": still}, {"position": "rad", "velocity": "rad/s"}, "")


def answer(torque, inertia=INERTIA):
    """Motion - (n,) each - of J*alpha = M - K_w*w + K_v*e + K_i*integral(e), e = -K_p*q - w, from rest, M constant."""
    stiff, damping, slow = BANDWIDTH / 5.0, inertia * BANDWIDTH, inertia * BANDWIDTH**2 / 6.0
    # states: q, w, integral of e, and 1 for the torque
    a = np.zeros((4, 4))
    a[0, 1] = 1.0
    a[1] = np.array([-damping * stiff, -damping - VISCOUS, slow, torque]) / INERTIA
    a[2, :2] = -stiff, -1.0
    one, state = expm(a * PERIOD), np.array([0.0, 0.0, 0.0, 1.0])
    found = np.empty((2, TIME.size))
    for k in range(TIME.size):
        found[:, k] = state[:2]
        state = one @ state
    return found


@pytest.mark.parametrize("inertia", [None, 5e-3])
def test_a_torque_that_is_too_large_moves_it_as_its_cascade_lets_it(inertia):
    """K_v = J*w, K_i = J*w**2/6, K_p = w/5 of the inertia that the cascade is laid out for, the model's or another."""
    held = Held(FREE, at_rest(), np.full(TIME.size, 0.02), inertia=inertia)
    expected = answer(0.02, inertia or INERTIA)
    tracked = track(held, BANDWIDTH)
    for found, exact in zip((tracked.position, tracked.velocity), expected, strict=True):
        # its integral is summed by rectangles of half a millisecond, and so is its damping
        assert np.abs(found - exact).max() < 5e-3 * np.abs(exact).max()


def test_the_measured_position_is_where_it_is_held():
    found = track(Held(FREE, at_rest(0.7), np.zeros(TIME.size)), BANDWIDTH)
    np.testing.assert_allclose(found.position, 0.7, atol=1e-12)
    np.testing.assert_allclose(found.velocity, 0.0, atol=1e-12)


@pytest.mark.parametrize("late", [3e-3, -3e-3])
def test_an_effort_that_is_reported_late_is_read_ahead(late):
    """A torque of t**2 that the recording has `late`, and the same in time, move it alike."""

    def velocity(delay, misalignment):
        effort = 0.1 * (np.maximum(TIME, 0.05) - delay - 0.05) ** 2
        return track(Held(FREE, at_rest(), effort, misalignment), BANDWIDTH).velocity

    in_time, told = velocity(0.0, 0.0), velocity(late, late)
    inside = slice(100, -10)
    assert np.abs(told - in_time)[inside].max() < 0.02 * np.abs(velocity(late, 0.0) - in_time)[inside].max()
