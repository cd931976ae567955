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
    """A sine at the middles of steps: both are second order in the step, and halving it shows that."""
    time_constant, omega = 3e-3, 120.0
    off = []
    for step in (PERIOD, PERIOD / 2.0):
        time = np.arange(round(0.2 / step)) * step
        reported = np.sin(omega * time)
        before, middles = reported[:1], []
        for value in reported:
            middle, before = EFFECT.stepped({"time_constant": time_constant}, np.array([value]), before, step)
            middles.append(middle[0])
        along = EFFECT.lagging({"time_constant": time_constant}, reported, step)
        settled = time > 30.0 * time_constant
        phase = np.arctan(omega * time_constant)
        exact = np.cos(phase) * np.sin(omega * time - phase)
        off.append([np.abs(found - exact)[settled].max() for found in (np.array(middles), along)])
    assert (np.array(off[0]) < 2e-4).all()
    assert (np.array(off[1]) < 0.3 * np.array(off[0])).all()
