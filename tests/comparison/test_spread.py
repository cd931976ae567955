"""How recordings differ beyond their own errors, against formulas."""

import numpy as np
import pytest
from scipy import stats

from bench.arrays import NORMAL95
from bench.comparison.spread import Excess, between, excess
from bench.diagnosis.same_axis import widened
from bench.parameter import Parameter


def numbers(values, error):
    reach = NORMAL95 * error
    return [Parameter(value, "", error, (value - reach, value + reach)) for value in values]


def test_the_variance_between_recordings_is_that_of_the_method_of_moments():
    values, error = [1.0, 2.0, 4.0, 5.0], 0.5
    found = excess([numbers(values, error)])
    assert found.variance == pytest.approx(np.var(values, ddof=1) - error**2)
    assert found.degrees == 3
    assert excess([numbers([1.0, 1.1], 0.5)]).variance == 0.0
    assert excess([numbers([1.0], 0.5), numbers([7.0], 0.5)]) == Excess(0.0, 0, 1.0)
    grouped = excess([numbers([1.0, 2.0], error), numbers([11.0, 12.0], error)])
    assert (grouped.variance, grouped.degrees) == (pytest.approx(0.5 - error**2), 2)


def test_the_expected_interval_is_students_and_never_below_the_recordings_own_errors():
    wide = between(numbers([1.0, 2.0, 3.0], 1e-3))
    assert wide.std_dev == pytest.approx(1.0)
    assert wide.predictive95 == pytest.approx(
        (2.0 - 4.302653 * np.sqrt(4.0 / 3.0), 2.0 + 4.302653 * np.sqrt(4.0 / 3.0))
    )
    low, high = between(numbers([2.0, 2.0], 0.1)).predictive95
    assert high - low == pytest.approx(2.0 * NORMAL95 * 0.1 * np.sqrt(1.5))


def test_a_joint_value_counts_what_averaging_leaves_of_the_spread():
    """Of two recordings alike half the variance between them, at one degree of freedom."""
    own = numbers([1.0, 1.2], 0.1)
    joint = numbers([1.1], 0.1 / np.sqrt(2.0))[0]
    found = widened(joint, Excess(variance=0.02, degrees=1, chance=0.0), own)
    assert found.std_error == pytest.approx(np.sqrt(0.005 + 0.01))
    assert found.half_width == pytest.approx(np.hypot(joint.half_width, 12.7062 * 0.1), rel=1e-5)
    assert found.value == joint.value
    assert widened(joint, Excess(0.0, 1, 1.0), own) is joint


def test_a_joint_value_has_the_spread_that_averaging_leaves():
    """tau**2*sum(w**2)/sum(w)**2 with w = 1/(s_k**2 + tau**2)."""
    own = [*numbers([1.0], 1.0), *numbers([2.0], 4.0)]
    weights = np.array([1.0 / 5.0, 1.0 / 20.0])
    assert Excess(4.0, 3, 0.0).of_joint(own) == pytest.approx(2.0 * np.sqrt(weights @ weights) / weights.sum())
    assert Excess(0.0, 3, 1.0).of_joint(own) == 0.0


def test_the_chance_of_a_spread_is_that_of_cochrans_q():
    values, error = [1.0, 2.0, 4.0], 0.8
    statistic = np.sum((np.array(values) - np.mean(values)) ** 2) / error**2
    assert excess([numbers(values, error)]).chance == pytest.approx(stats.chi2.sf(statistic, 2))
    assert Excess(1.0, 4, 0.1).reach == pytest.approx(stats.t.ppf(0.975, 4))
    assert Excess(1.0, 0, 1.0).reach == 0.0
