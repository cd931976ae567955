"""Motions: speed is the derivative of position, acceleration that of speed, and the axis can follow."""

import numpy as np
import pytest

from bench.validation.independent.references import (
    Chirp,
    Multisine,
    Ramps,
    multisine,
    random_motion,
    slow_reversals,
    staircase,
)
from bench.validation.independent.rig import random_rig


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("linear", [False, True])
def test_derivatives_agree_and_it_starts_and_ends_at_rest(seed, linear):
    rng = np.random.default_rng(seed)
    axis = random_rig(rng, linear=linear)
    motion = random_motion(axis, rng, 5.0)
    time = np.linspace(0.0, motion.duration + 0.1, 200_001)
    q, w, a = motion.at(time)
    dt = time[1]
    assert np.abs((q[2:] - q[:-2]) / (2 * dt) - w[1:-1]).max() < 1e-5 * axis.top_speed
    assert np.abs((w[2:] - w[:-2]) / (2 * dt) - a[1:-1]).max() < 0.02 * np.abs(a).max()
    assert w[0] == a[0] == 0.0
    assert abs(w[-1]) < 1e-9 * axis.top_speed
    assert 0.6 * axis.top_speed < np.abs(w).max() <= 1.01 * axis.top_speed
    assert np.abs(a).max() < axis.peak_torque / axis.inertia
    assert (w > 0.1 * axis.top_speed).any() and (w < -0.1 * axis.top_speed).any()


def test_a_ramp_in_closed_form():
    # 2 rad/s reached in 1 s, averaged over 0.2 s
    ramp = Ramps([(0.0, 0.0), (1.0, 2.0), (2.0, 2.0), (3.0, 0.0)], 0.2)
    q, w, a = ramp.at(np.array([0.1, 0.6, 1.5, 3.2]))
    assert w == pytest.approx([2 * 0.1**2 / (2 * 0.2), 1.0, 2.0, 0.0], abs=1e-12)
    assert a == pytest.approx([1.0, 2.0, 0.0, 0.0], abs=1e-12)
    assert q[-1] == pytest.approx(ramp.distance) == 4.0
    assert q[0] == pytest.approx(2 * 0.1**3 / (6 * 0.2))


def test_phases_do_what_they_are_named_for():
    stairs = staircase(100.0, 6, 1000.0, 0.1, 0.01)
    _, w, a = stairs.at(np.linspace(0.0, stairs.duration, 5001))
    assert len(np.unique(np.round(w[np.abs(a) < 1e-9], 6))) == 13
    slow = slow_reversals([1.0, 2.0], 0.2, 0.01)
    _, w, _ = slow.at(np.linspace(0.0, slow.duration, 5001))
    assert np.sum(np.diff(np.sign(w)) != 0) >= 4
    sines = multisine(20.0, 800.0, 2.0, np.random.default_rng(0))
    assert isinstance(sines, Multisine)
    _, w, a = sines.at(np.linspace(0.0, 2.0, 5001))
    assert np.abs(w).max() < 25.0 and 200.0 < np.abs(a).max() < 1000.0
    _, w, _ = Chirp(2.0, 0.1, 1.0, 10.0).at(np.array([1.0]))
    angle = 2 * np.pi * (1.0 + 0.5 * 4.5)
    assert w[0] == pytest.approx(0.1 * 2 * np.pi * 5.5 * np.cos(angle))
