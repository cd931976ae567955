import math

import numpy as np
import pytest
import scipy.signal
import scipy.special

from bench.arrays import NORMAL95, column_rms, recurrence, recursive_filter, rms, symmetric_inverse


def test_rms_of_whole_periods_of_a_sine_is_its_amplitude_over_root_two_and_of_columns_that_of_each():
    phase = 2.0 * np.pi * np.arange(1000) / 1000
    assert rms(3.0 * np.sin(5.0 * phase)) == pytest.approx(3.0 / math.sqrt(2.0), rel=1e-12)
    assert isinstance(rms(phase), float)
    table = np.random.default_rng(1).normal(size=(50, 3)) * [1.0, 10.0, 0.1]
    np.testing.assert_allclose(column_rms(table), [rms(column) for column in table.T], rtol=1e-14)
    assert rms(table) == pytest.approx(math.sqrt(float(np.mean(column_rms(table) ** 2))), rel=1e-14)


def test_the_normal_interval_holds_95_percent():
    assert scipy.special.erf(NORMAL95 / math.sqrt(2.0)) == pytest.approx(0.95, abs=1e-12)


@pytest.mark.parametrize("rank", [0, 1, 3, 4])
def test_inverse_of_symmetric_matrices_is_that_of_numpy(rank):
    factors = np.random.default_rng(rank).normal(size=(5, 4, rank))
    signs = np.where(np.arange(rank) % 2, -1.0, 1.0)
    matrices = (factors * signs) @ factors.transpose(0, 2, 1)
    expected = np.linalg.pinv(matrices, rcond=1e-10, hermitian=True)
    np.testing.assert_allclose(symmetric_inverse(matrices, 1e-10), expected, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(symmetric_inverse(matrices[0], 1e-10), expected[0], rtol=1e-9, atol=1e-12)
    assert symmetric_inverse(np.empty((2, 0, 0)), 1e-8).shape == (2, 0, 0)


@pytest.mark.parametrize("kept", [0.0, 0.3, 0.999, 1.0])
def test_a_recurrence_of_constant_share_is_a_geometric_sum(kept):
    found = recurrence(np.full(300, kept), np.ones(300))
    powers = np.arange(1, 301)
    expected = powers if kept == 1.0 else (1.0 - kept**powers) / (1.0 - kept)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_a_recurrence_of_any_shares_is_what_a_step_at_a_time_gives():
    rng = np.random.default_rng(0)
    kept, added = rng.uniform(size=1000), rng.normal(size=1000)
    kept[rng.integers(1000, size=50)] = 0.0
    expected, state = np.empty(1000), 0.0
    for k in range(1000):
        state = kept[k] * state + added[k]
        expected[k] = state
    np.testing.assert_allclose(recurrence(kept, added), expected, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize(
    ("numerator", "denominator"),
    [([0.3, 0.1], [1.0, -0.6]), ([0.01], [1.0, -0.99]), ([0.2, 0.1, 0.05], [1.0, -1.9, 0.95])],
)
def test_a_recursive_filter_is_that_of_scipy(numerator, denominator):
    values = np.random.default_rng(2).normal(size=4000)
    expected = scipy.signal.lfilter(numerator, denominator, values)
    np.testing.assert_allclose(recursive_filter(numerator, denominator, values), expected, rtol=1e-10, atol=1e-11)


def test_a_first_order_filter_keeps_what_it_held():
    """y[t] = 0.5*y[t - 1]: of 8 held before, 4, 2, 1 are left."""
    np.testing.assert_allclose(recursive_filter([1.0], [1.0, -0.5], np.zeros(3), held=4.0), [4.0, 2.0, 1.0])
