"""The statistics of a check: closed forms by SciPy's distributions, and the rates it promises, on drawn numbers."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binomtest
from scipy.stats import t as student

from bench.comparison.difference import CHANGED, ENOUGH, NOT_EQUIVALENT, SAME, Comparison, Difference, Measured, holm
from bench.parameter import Parameter


@pytest.mark.parametrize("degrees", [3.0, 40.0, math.inf])
@pytest.mark.parametrize("margin", [0.0, 0.5, 1.0])
def test_interval_chance_and_equivalence_are_students(degrees, margin):
    """A chance counts both directions; the same is shown by two one-sided tests, and excludes a change."""
    law, error = student(degrees), 0.4
    for value in np.linspace(-5.0, 5.0, 81).tolist():
        found = Difference(value, error, degrees)
        reach = error * law.ppf(0.975)
        assert found.interval(0.95) == pytest.approx((value - reach, value + reach))
        sides = ((abs(value) + side * margin) / error for side in (-1.0, 1.0))
        assert found.chance(margin) == pytest.approx(min(1.0, sum(map(law.sf, sides))))
        assert found.within(margin) == (abs(value) + error * law.ppf(1.0 - NOT_EQUIVALENT) < margin)
        assert not (found.within(margin) and found.chance(margin) <= NOT_EQUIVALENT)


def test_an_exact_difference_is_judged_by_the_margin_alone():
    assert [Difference(value, 0.0).chance(1.0) for value in (0.9, 1.0, 1.1)] == [1.0, 1.0, 0.0]
    assert Difference(0.9, 0.0).within(1.0)


def drawn(rng, count, spread, error):
    """Recordings' values and their own errors, as a baseline would have them."""
    values = rng.normal(scale=math.hypot(spread, error), size=count)
    found = [Parameter(value, "", error, (value - 1.96 * error, value + 1.96 * error)) for value in values.tolist()]
    middle = float(np.mean(values))
    return Measured.of(Parameter(middle, "", error, (middle - error, middle + error)), found)


@pytest.mark.parametrize(
    ("recordings", "spread", "error", "stated"),
    [(ENOUGH, 0.3, 1.0, 0.0), (ENOUGH, 3.0, 1.0, 0.0), (8, 0.0, 1.0, 0.0), (1, 0.5, 0.3, 0.5), (3, 0.5, 0.3, 0.5)],
)
def test_false_alarms_have_the_promised_rate(recordings, spread, error, stated):
    """Enough recordings whatever their spread, few where it is as stated."""
    rng, rate, count = np.random.default_rng(1), 0.01, 1000
    alarms = 0
    for _ in range(count):
        baseline, now = drawn(rng, recordings, spread, error), drawn(rng, 1, spread, error)
        alarms += Difference.of(baseline, now, between=stated).chance(0.0) <= rate
    assert binomtest(alarms, count, rate, "greater").pvalue > 1e-3


def test_an_interval_of_small_samples_keeps_its_degrees():
    reach = 2.776  # of Student's t at 4 degrees of freedom
    found = Measured.of(Parameter(1.0, "", 0.1, (1.0 - reach * 0.1, 1.0 + reach * 0.1)))
    assert found.degrees == pytest.approx(4.0, rel=0.01)
    assert math.isinf(Measured.of(Parameter(1.0, "", 0.1, (0.8041, 1.1959))).degrees)


def test_few_recordings_add_their_own_errors_and_the_stated_spread():
    """s_n**2/k_n + s_b**2/k_b + tau**2*(1/k_n + 1/k_b), with tau the larger of the stated one and what they show."""
    baseline = Measured(10.0, "N*m", 0.3, recordings=3, spread=0.5)  # shows tau = 0.4 beyond its own errors
    now = Measured(12.0, "N*m", 0.6, recordings=2)
    shares = 1.0 / 2.0 + 1.0 / 3.0
    stated, shown = (Difference.of(baseline, now, between=tau) for tau in (1.0, 0.1))
    own = 0.36 / 2.0 + 0.09 / 3.0
    assert (stated.value, stated.std_error) == (2.0, pytest.approx(math.sqrt(own + shares)))
    assert shown.std_error == pytest.approx(math.sqrt(own + 0.16 * shares))
    assert Difference.of(replace(baseline, spread=None), now, 0.0).std_error == pytest.approx(math.sqrt(own))
    assert math.isinf(stated.degrees)
    known = Difference.of(Measured(1.0, "", 0.3), Measured(1.0, "", 0.4), between=0.0, known=2.0)
    assert known.std_error == pytest.approx(math.sqrt(0.09 + 0.16 + 2.0 * 4.0))


def test_enough_recordings_judge_by_their_own_spread_alone():
    """Total variance of five, with Student's t at 4 degrees; more only by what this recording is worse than theirs."""
    baseline = Measured(10.0, "N*m", 0.3, recordings=5, spread=0.5)
    alike = Difference.of(baseline, Measured(11.0, "N*m", 0.2, degrees=7.0), between=9.0)
    assert (alike.std_error, alike.degrees) == (pytest.approx(0.5 * math.sqrt(1.2)), pytest.approx(4.0))
    worse = Difference.of(baseline, Measured(11.0, "N*m", 0.5, degrees=7.0, recordings=2), between=9.0)
    total, more = 0.25 * (1.0 / 2.0 + 1.0 / 5.0), (0.25 - 0.09) / 2.0
    assert worse.std_error == pytest.approx(math.sqrt(total + more))
    assert worse.degrees == pytest.approx((total + more) ** 2 / (total**2 / 4.0 + more**2 / 7.0))
    four = Difference.of(replace(baseline, recordings=4), Measured(11.0, "N*m", 0.0), between=9.0)
    assert four.std_error == pytest.approx(math.sqrt(0.09 / 4.0 + 81.0 * 1.25))


def test_degrees_add_up_as_satterthwaite_says():
    found = Difference.of(Measured(0.0, "", 3.0, degrees=4.0), Measured(0.0, "", 4.0, degrees=9.0), between=0.0)
    assert found.degrees == pytest.approx(25.0**2 / (81.0 / 4.0 + 256.0 / 9.0))


def test_several_recordings_have_the_mean_of_their_squared_errors_and_the_least_degrees():
    def found(value, error, reach):
        return Parameter(value, "N*m", error, (value - reach * error, value + reach * error))

    alone = [found(1.0, 0.3, 1.959964), found(2.0, 0.4, 2.776445), found(4.0, math.nan, 1.0)]
    several = Measured.of(found(1.7, 0.2, 1.959964), alone)
    assert (several.value, several.recordings) == (1.7, 2)
    assert several.std_error == pytest.approx(math.sqrt(0.5 * (0.09 + 0.16)))
    assert several.spread == pytest.approx(math.sqrt(0.5))
    assert several.degrees == pytest.approx(4.0, rel=1e-3)
    one = Measured.of(found(1.7, 0.2, 1.959964), alone[1:])
    assert (one.std_error, one.recordings, one.spread) == (0.2, 1, None)


def test_a_ratio_passes_on_the_errors_of_both():
    """now/baseline - 1 = 0.2 with sqrt((1.2*0.3)**2 + 0.4**2)/10."""
    baseline, now = Parameter(10.0, "", 0.3, (9.0, 11.0)), Parameter(12.0, "", 0.4, (11.0, 13.0))
    found = Difference.relative(baseline, now)
    assert (found.value, found.std_error) == (pytest.approx(0.2), pytest.approx(math.hypot(0.36, 0.4) / 10.0))


@pytest.mark.parametrize(
    ("value", "outside"), [(0.79, False), (0.81, True), (-0.59, False), (-0.61, True), (math.nan, True)]
)
def test_what_lies_outside_of_a_range_does_so_by_more_than_its_errors(value, outside):
    """Range -0.3 to 0.5, three standard errors of 0.1."""
    assert Difference(value, 0.1).outside(-0.3, 0.5, errors=3.0) is outside


def test_several_differences_count_by_the_likeliest_if_they_have_one_sign():
    two, opposite = ([Difference(3.0, 1.0), Difference(sign * 4.0, 1.0)] for sign in (1.0, -1.0))
    found = Comparison("x", "N*m", 1.0, 4.0, tuple(two), 1.0)
    assert found.tested().chance == two[0].chance(1.0) > two[1].chance(1.0)
    assert found.tested(least_chance=0.9).chance == 0.9
    assert replace(found, differences=tuple(opposite)).tested().chance == 1.0
    assert replace(found, held_back="the rig is another").tested().chance == 1.0


@pytest.mark.parametrize(
    ("differences", "chance", "reason"),
    [
        ([(3.3, 1.0)], 0.01, "the difference is 3.3 margins, but it is known to ± 2 N*m only"),
        ([(0.5, 1.0)], 0.38, "the difference is known to ± 2 N*m only, so it may exceed the margin"),
        ([(3.3, 1.0), (-3.3, 1.0)], 1.0, "opposite sign"),
        ([(30.0, 1.0)], 0.5, "stronger noise may explain the difference"),
    ],
)
def test_what_is_undecided_has_a_reason(differences, chance, reason):
    """Of a margin of 1 N*m, with intervals of 95 % of 1.96 standard errors."""
    found = Comparison("x", "N*m", 1.0, 4.3, tuple(Difference(*one) for one in differences), 1.0, chance=chance)
    assert reason in found.reason
    assert [replace(found, result=result).reason for result in (SAME, CHANGED)] == ["", ""]
    assert replace(found, held_back="the rig is another").reason == "the rig is another"


@pytest.mark.parametrize(
    ("chances", "silent", "raised"),
    [
        ([0.01, 0.04, 0.03, 0.005], 0, [0.03, 0.06, 0.06, 0.02]),  # R, p.adjust, method holm
        ([0.02, 0.02, 0.9], 0, [0.06, 0.06, 0.9]),
        ([0.001], 100, [0.101]),
        ([0.5, 0.6], 0, [1.0, 1.0]),
        ([], 0, []),
    ],
)
def test_holm_raises_chances_from_the_smallest_on(chances, silent, raised):
    assert holm(np.array(chances), silent) == pytest.approx(raised)
