"""The statistics of a check: laws of its chances, and the rates it promises, on drawn numbers."""

import math

import numpy as np
import pytest
from scipy.stats import binomtest

from bench.baseline.difference import ENOUGH, NOT_EQUIVALENT, Difference
from bench.baseline.measured import Measured
from bench.fit.parameter import Parameter


@pytest.mark.parametrize("degrees", [3.0, 40.0, math.inf])
def test_answers_exclude_each_other(degrees):
    for value in np.linspace(-5.0, 5.0, 41):
        found = Difference(float(value), 0.4, degrees)
        assert not (found.within(1.0) and found.chance(1.0) <= NOT_EQUIVALENT)


def test_a_chance_falls_with_the_difference_and_rises_with_the_margin():
    chances = [Difference(value, 1.0, 8.0).chance(0.5) for value in (0.0, 1.0, 2.0, 4.0)]
    assert chances == sorted(chances, reverse=True)
    assert chances[0] == 1.0
    assert Difference(2.0, 1.0, 8.0).chance(1.0) > Difference(2.0, 1.0, 8.0).chance(0.5)
    assert Difference(1.96, 1.0, math.inf).chance(0.0) == pytest.approx(0.05, abs=1e-3)
    assert Difference(-1.96, 1.0, math.inf).chance(0.0) == pytest.approx(0.05, abs=1e-3)


def test_an_exact_difference_is_judged_by_the_margin_alone():
    assert Difference(0.9, 0.0, math.inf).chance(1.0) == 1.0
    assert Difference(1.1, 0.0, math.inf).chance(1.0) == 0.0
    assert Difference(0.9, 0.0, math.inf).within(1.0)


def drawn(rng, count, spread, error):
    """Recordings' values and their own errors, as a baseline would have them."""
    values = rng.normal(scale=math.hypot(spread, error), size=count)
    found = [Parameter(value, "", error, (value - 1.96 * error, value + 1.96 * error)) for value in values.tolist()]
    middle = float(np.mean(values))
    return Measured.of(Parameter(middle, "", error, (middle - error, middle + error)), found)


@pytest.mark.parametrize("recordings", [ENOUGH, 8])
@pytest.mark.parametrize("spread", [0.0, 0.3, 1.0, 3.0])
def test_recordings_of_a_baseline_hold_the_rate_whatever_their_spread(recordings, spread):
    rng, rate, count = np.random.default_rng(1), 0.01, 2000
    alarms = 0
    for _ in range(count):
        baseline, now = drawn(rng, recordings, spread, 1.0), drawn(rng, 1, spread, 1.0)
        alarms += Difference.of(baseline, now, between=0.0).chance(0.0) <= rate
    assert binomtest(alarms, count, rate, "greater").pvalue > 1e-3


@pytest.mark.parametrize("recordings", [1, 3])
def test_few_recordings_hold_it_where_the_spread_is_as_stated(recordings):
    rng, rate, count = np.random.default_rng(2), 0.01, 4000
    alarms = 0
    for _ in range(count):
        baseline, now = drawn(rng, recordings, 0.5, 0.3), drawn(rng, 1, 0.5, 0.3)
        alarms += Difference.of(baseline, now, between=0.5).chance(0.0) <= rate
    assert binomtest(alarms, count, rate, "greater").pvalue > 1e-3


def test_what_differs_by_its_margin_is_rarely_called_the_same():
    rng, margin, count = np.random.default_rng(3), 3.0, 4000
    same = sum(Difference(margin + rng.normal(), 1.0, math.inf).within(margin) for _ in range(count))
    assert binomtest(same, count, NOT_EQUIVALENT, "greater").pvalue > 1e-3


def test_an_interval_of_small_samples_keeps_its_degrees():
    reach = 2.776  # of Student's t at 4 degrees of freedom
    found = Measured.of(Parameter(1.0, "", 0.1, (1.0 - reach * 0.1, 1.0 + reach * 0.1)))
    assert found.degrees == pytest.approx(4.0, rel=0.01)
    assert math.isinf(Measured.of(Parameter(1.0, "", 0.1, (0.8041, 1.1959))).degrees)
