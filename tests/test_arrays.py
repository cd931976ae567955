import math

import numpy as np
import pytest
import scipy.special

from bench.arrays import column_rms, recurrence, rms
from bench.statistics import NORMAL95


def test_rms_of_whole_periods_of_a_sine_is_its_amplitude_over_root_two():
    phase = 2.0 * np.pi * np.arange(1000) / 1000
    assert rms(3.0 * np.sin(5.0 * phase)) == pytest.approx(3.0 / math.sqrt(2.0), rel=1e-12)
    assert isinstance(rms(phase), float)


def test_rms_of_columns_is_that_of_each_alone():
    table = np.random.default_rng(1).normal(size=(50, 3)) * [1.0, 10.0, 0.1]
    np.testing.assert_allclose(column_rms(table), [rms(column) for column in table.T], rtol=1e-14)
    assert rms(table) == pytest.approx(math.sqrt(float(np.mean(column_rms(table) ** 2))), rel=1e-14)


def test_the_normal_interval_holds_95_percent():
    assert scipy.special.erf(NORMAL95 / math.sqrt(2.0)) == pytest.approx(0.95, abs=1e-12)


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
