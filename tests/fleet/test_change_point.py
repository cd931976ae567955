"""A change is found when and where it is, and not where there is none; false alarms come no oftener than stated."""

import numpy as np
import pytest
from scipy import stats

from bench.fleet.change_point import change_point, expected


def test_one_more_recording_is_judged_by_the_prediction_interval_of_the_next():
    values = np.array([1.0, 1.2, 0.9, 1.1, 2.0])
    found = change_point(values, np.full(5, 1e-6))
    before = values[:-1]
    error = np.std(before, ddof=1) * np.sqrt(1.0 + 1.0 / 4.0)
    p = 2.0 * stats.t.sf((2.0 - before.mean()) / error, 3)
    assert (found.place, found.before, found.after) == (4, pytest.approx(1.05), pytest.approx(2.0))
    assert found.chance == pytest.approx(4 * p)
    assert found.reach == pytest.approx(stats.t.ppf(0.975, 3) * error)


def test_two_sides_are_compared_as_students_test_does():
    values = np.array([1.0, 1.2, 0.9, 2.1, 2.0, 2.3])
    found = change_point(values, np.full(6, 1e-6))
    expected = stats.ttest_ind(values[:3], values[3:])
    assert found.place == 3
    assert found.size == pytest.approx(abs(expected.statistic))
    assert found.chance == pytest.approx(5 * expected.pvalue)


def test_values_that_agree_by_chance_are_no_surer_than_their_own_errors():
    found = change_point(np.array([1.0, 1.0, 1.0, 1.001]), np.full(4, 0.01))
    assert found.size < 1.0
    assert found.chance == 1.0


def test_the_floor_of_a_step_is_the_own_errors_of_each_side():
    """Values that agree on both sides: sqrt(s_1**2/1 + (s_2**2 + s_3**2 + s_4**2)/9), at two degrees of freedom."""
    found = change_point(np.array([1.0, 2.0, 2.0, 2.0]), np.array([0.3, 0.1, 0.2, 0.2]))
    error = np.sqrt(0.09 + 0.09 / 9.0)
    assert (found.place, found.before, found.after) == (1, pytest.approx(1.0), pytest.approx(2.0))
    assert found.size == pytest.approx(1.0 / error)
    assert found.reach == pytest.approx(stats.t.ppf(0.975, 2) * error)
    assert found.chance == pytest.approx(3.0 * 2.0 * stats.t.sf(1.0 / error, 2))


def test_the_next_recording_is_expected_by_the_scatter_about_both_means():
    """Mean -+ t*sqrt(p*(1 + 1/c)): of two and three values, p = (2*0.5**2 + 2*1)/3 at three degrees of freedom."""
    values, few = np.array([1.0, 2.0, 5.0, 6.0, 7.0]), np.full(5, 0.1)
    pooled, student = (0.5 + 2.0) / 3.0, stats.t.ppf(0.975, 3)
    before, after = expected(values, few, 2)
    for interval, mean, count in ((before, 1.5, 2.0), (after, 6.0, 3.0)):
        reach = student * np.sqrt(pooled * (1.0 + 1.0 / count))
        assert interval == pytest.approx((mean - reach, mean + reach))
    before, after = expected(values, np.array([3.0, 4.0, 0.1, 0.1, 0.1]), 2)  # own errors, of one side
    reach = student * np.sqrt(12.5 * 1.5)
    assert before == pytest.approx((1.5 - reach, 1.5 + reach))
    assert after[1] - after[0] == pytest.approx(2.0 * student * np.sqrt(pooled * 4.0 / 3.0))


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 2.0]])
def test_two_recordings_tell_no_change(values):
    assert change_point(np.array(values), np.ones(len(values))) is None


@pytest.mark.parametrize("count", [4, 30])
@pytest.mark.parametrize(("between", "unlike"), [(0.0, 0.0), (1.0, 0.5), (10.0, 1.0)])
def test_false_alarms_come_no_oftener_than_stated(count, between, unlike):
    """Over series without a step: errors alike and unlike, recordings that differ by no more than them and by far."""
    rng, runs = np.random.default_rng(count), 2000
    alarms = np.zeros(2)
    for _ in range(runs):
        errors = np.exp(rng.normal(0.0, unlike, count))
        chance = change_point(rng.normal(size=count) * np.hypot(errors, between), errors).chance
        alarms += chance < np.array([0.05, 0.01])
    assert np.all(alarms <= stats.binom.ppf(0.999, runs, [0.05, 0.01]))


@pytest.mark.parametrize("place", [3, 10, 17])
def test_a_step_of_five_standard_deviations_is_found_where_it_is(place):
    rng, found = np.random.default_rng(place), []
    for _ in range(200):
        values = rng.normal(1.0, 0.01, 20)
        values[place:] += 0.05
        found.append(change_point(values, np.full(20, 0.005)))
    assert np.mean([one.chance < 1e-3 for one in found]) > 0.95
    assert np.mean([one.place == place for one in found]) > 0.95
    within = [abs(one.after - one.before - 0.05) < one.reach for one in found]
    assert stats.binom.cdf(sum(within), len(within), 0.95) > 1e-3
