"""What is positive by nature is known up to a factor, and its interval never holds what it cannot be."""

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.fit.quantities import Uncertain
from bench.parameter import Parameter

NUMBERS = Uncertain(cast(Any, SimpleNamespace()), np.empty(0), np.empty((0, 0)), 2.0, ())


def test_an_interval_of_what_is_positive_is_one_of_its_logarithm():
    found = NUMBERS.parameter(3.0, 1.8, "s", positive=True)
    assert [math.log(bound / 3.0) for bound in found.ci95] == pytest.approx([-1.2, 1.2])
    assert NUMBERS.parameter(3.0, 1.8, "s").ci95 == pytest.approx((-0.6, 6.6))


def test_of_what_is_known_well_both_are_the_same():
    found, plain = (NUMBERS.parameter(3.0, 0.003, "s", positive) for positive in (True, False))
    assert found.ci95 == pytest.approx(plain.ci95, abs=3.0 * 0.002**2)


def test_a_factor_stays_one_where_the_value_moves():
    found = Parameter(4.0, "s", 1.0, (2.0, 8.0))
    assert found.at(1.0, positive=True).ci95 == pytest.approx((0.5, 2.0))
    assert found.at(1.0, positive=False).ci95 == pytest.approx((-1.0, 5.0))


def test_zero_has_no_factor_so_its_interval_keeps_its_width():
    found = Parameter(0.0, "s", 1.0, (-2.0, 3.0))
    assert found.at(1.0, positive=True).ci95 == pytest.approx((-1.0, 4.0))


@pytest.mark.parametrize(
    ("effect", "positive"),
    [
        ("backlash", {"contact_stiffness", "contact_damping"}),
        ("stribeck_friction", {"static_friction", "stribeck_velocity"}),
        ("load_torque_event", set()),  # an instant is on no scale
        ("elastic_coupling", {"resonance_frequency"}),  # without damping it is one, too
    ],
)
def test_what_is_exactly_absent_at_zero_is_not(effect, positive):
    assert catalogue()[effect].positive == positive
