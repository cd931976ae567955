"""Intervals of every level, names against what is hidden, and the laws of the figures made of them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from bench.diagnosis.name import NamedEffect
from bench.effects.catalogue import catalogue
from bench.parameter import Parameter
from bench.validation.coverage import (
    LEVELS,
    NOTHING,
    NOTHING_MISSING,
    REFUSED,
    Coverage,
    Named,
    Scored,
    Share,
    coverage,
    naming,
)
from bench.validation.plan import Plan
from bench.validation.validate import drawn
from tests.validation.population import short


def parameter(value, error, reach=1.959963984540054):
    return Parameter(value, "kg*m**2", error, (value - reach * error, value + reach * error))


@pytest.mark.parametrize("degrees", [2.0, 7.5, 40.0, np.inf])
@pytest.mark.parametrize("level", [0.5, 0.8, 0.95, 0.99])
def test_an_interval_of_any_level_is_a_students(degrees, level):
    found = parameter(3.0, 0.2, stats.t.ppf(0.975, degrees))
    low, high = found.interval(level)
    expected = 0.2 * stats.t.ppf(0.5 + 0.5 * level, degrees)
    assert [3.0 - low, high - 3.0] == pytest.approx([expected, expected], rel=1e-4)


def test_a_share_of_true_values_from_an_array_counts_in_whole_numbers_that_json_writes():
    scored = [Scored("diagnose", "", "inertia", np.float64(3.0), 3.0, parameter(3.0, 0.2))] * 2
    found = Coverage.of("diagnose", "inertia", scored, 2, "nulls")
    assert [type(share.count) for share in found.inside] == [int] * len(LEVELS)


def test_an_interval_that_is_wide_beside_its_covariance_scales_as_a_normal_ones():
    low, high = parameter(3.0, 0.01, stats.t.ppf(0.975, 5)).widened(1.0).interval(0.5)
    assert high - low == pytest.approx(2.0 * 1.0 * 0.6745 / 1.95996, rel=1e-2)


@pytest.mark.parametrize("degrees", [6, 1e9])
def test_coverage_of_what_is_as_uncertain_as_it_says_is_nominal(degrees):
    rng = np.random.default_rng(1)
    error = np.sqrt(rng.chisquare(degrees, 4000) / degrees)
    scored = [
        Scored("identify", "", "inertia", 1.0, 1.0, parameter(1.0 + 0.1 * z, 0.1 * s, stats.t.ppf(0.975, degrees)))
        for z, s in zip(rng.standard_normal(4000), error, strict=True)
    ]
    found = Coverage.of("identify", "inertia", scored, 4100, "g")
    assert found.told == 4000
    for level, share in zip(LEVELS, found.inside, strict=True):
        low, high = share.bounds
        assert low - 0.01 < level < high + 0.01
    assert found.bias == pytest.approx(0.0, abs=3 * found.bias_error)
    assert found.spread == pytest.approx(0.1, rel=0.05)
    if degrees > 1e3:
        assert found.width_over_error == pytest.approx(1.96, rel=0.05)


def test_bounds_are_clopper_and_pearsons():
    assert Share(0, 300).bounds == pytest.approx((0.0, 1.0 - 0.025 ** (1 / 300)))
    low, high = Share(7, 20).bounds
    assert stats.binom.sf(6, 20, low) == pytest.approx(0.025, rel=1e-3)
    assert stats.binom.cdf(7, 20, high) == pytest.approx(0.025, rel=1e-3)
    assert Share(0, 0).bounds == (0.0, 1.0)


def effect(name, *alike):
    return NamedEffect(catalogue()[name], {}, alike, {})


@pytest.mark.parametrize(
    ("given", "hidden", "false", "missed"),
    [
        ([effect("unbalance")], ("unbalance",), (), ()),
        ([effect("torque_offset", "direction_dependent_friction")], ("direction_dependent_friction",), (), ()),
        ([effect("torque_offset")], ("unbalance",), ("torque_offset",), ("unbalance",)),
        ([effect("cogging_torque"), effect("cogging_torque")], ("cogging_torque",), ("cogging_torque",), ()),
        ([], ("unbalance",), (), ("unbalance",)),
        ([effect("unbalance")], (), ("unbalance",), ()),
    ],
)  # fmt: skip
def test_names_are_held_against_what_is_hidden(given, hidden, false, missed):
    found = Named.of("explained", given, hidden)
    assert (found.false, found.missed) == (false, missed)
    assert found.exact is not (bool(false) or bool(missed))


def runs():
    plain = drawn(Plan(5, population=short).case(0))
    scored = Scored("diagnose", "", "inertia", 1.0, 1.0, parameter(1.05, 0.1))
    right = Named("explained", ("unbalance",))
    return (
        replace(plain, named=Named("nothing_missing"), scored=(scored,)),
        replace(plain, named=Named("explained", ("backlash",), ("backlash",))),
        replace(plain, hidden=("unbalance",), named=right, scored=(scored,)),
        replace(plain, hidden=("unbalance",), named=Named(missed=("unbalance",), reason="too short")),
    )


def test_naming_counts_runs():
    found = naming(runs())
    assert found is not None
    assert (found.nulls, found.false, found.silent) == (Share(1, 2), Share(1, 3), Share(1, 3))
    assert (found.exact, found.refused) == (Share(2, 4), Share(1, 4))
    assert found.named == {"unbalance": Share(1, 2)}
    assert found.falsely == {"backlash": 1}
    assert found.confusion[NOTHING] == {NOTHING_MISSING: 1, "backlash": 1}
    assert found.confusion["unbalance"] == {"unbalance": 1, REFUSED: 1}
    assert naming([replace(run, named=None) for run in runs()]) is None


def test_groups_hold_what_they_are_called_by():
    found = {(each.by, each.group, each.quantity): each for each in coverage(runs())}
    assert found["diagnose", "nulls", "inertia"].runs == 2
    assert found["diagnose", "1 effect", "inertia"].told == 1
    assert found["diagnose", "1 effect named", "inertia"].runs == 1
    assert found["identify", "nulls", "inertia"].told == 0
