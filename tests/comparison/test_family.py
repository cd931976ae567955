"""Holm's procedure: rejects from the smallest chance on until one is not."""

import numpy as np
import pytest

from bench.comparison.difference import holm


@pytest.mark.parametrize(
    ("chances", "silent", "rejected"),
    [
        ([0.001, 0.02, 0.9], 0, [True, True, False]),
        ([0.9, 0.02, 0.001], 0, [False, True, True]),
        ([0.02, 0.02, 0.02], 0, [False, False, False]),
        ([0.001], 100, [False]),
        ([], 0, []),
    ],
)
def test_holm_rejects_from_the_smallest_until_one_is_not(chances, silent, rejected):
    assert (holm(np.array(chances), silent) <= 0.05).tolist() == rejected


def test_adjusted_chances_of_a_published_example():
    """0.01, 0.04, 0.03, 0.005 at four tests: 0.03, 0.06, 0.06, 0.02 (R, p.adjust, method holm)."""
    np.testing.assert_allclose(holm(np.array([0.01, 0.04, 0.03, 0.005])), [0.03, 0.06, 0.06, 0.02])
