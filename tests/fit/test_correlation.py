"""Correlations of an estimate are those of estimates of the same motion with other noise."""

from dataclasses import replace

import numpy as np

from bench.fit.identify import identify
from tests.fit.motions import NAMES, RIG, recording

RECORDINGS = 120


def test_correlations_are_those_of_repeated_recordings():
    rng = np.random.default_rng(4)
    plain = recording(np.random.default_rng(3), torque_noise=0.0, velocity_noise=0.0, bias=15.0, duration=2.0)
    found = []
    for _ in range(RECORDINGS):
        noisy = {
            "velocity": plain["velocity"] + rng.normal(scale=0.03, size=len(plain)),
            "current": plain["current"] + rng.normal(scale=0.01, size=len(plain)),
        }
        found.append(identify(replace(plain, signals={**plain.signals, **noisy}), RIG))
    values = np.array([[one[name].value for name in NAMES] for one in found])
    stated = np.mean([one.correlation[:3, :3] for one in found], axis=0)
    assert np.abs(stated[1, 2]) > 0.5  # speed and its sign are alike
    # the standard error of a correlation r of n pairs is (1 - r**2)/sqrt(n)
    assert np.all(np.abs(np.corrcoef(values.T) - stated) < 3.5 * (1.0 - stated**2) / np.sqrt(RECORDINGS) + 1e-12)


def test_correlations_of_several_recordings_are_those_of_their_sum():
    """Recordings of one motion with the same information have its correlations."""
    each = [recording(np.random.default_rng(seed), duration=4.0) for seed in (5, 6)]
    both, one = identify(each, RIG), identify(each[0], RIG)
    assert both.correlation.shape == (len(both), len(both))
    assert np.allclose(np.diag(both.correlation)[:3], 1.0)
    covariance = both.covariance[:3, :3]
    assert np.allclose(np.sqrt(np.diag(covariance)), [both[name].std_error for name in NAMES])
    assert np.all(np.linalg.eigvalsh(both.correlation[:3, :3]) > 0.0)
    assert np.isnan(one.correlation[[*one].index("load_moment_of_inertia")]).all()
