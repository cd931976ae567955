"""Tails and quantiles against scipy's, which come from another library, and against closed forms."""

import math

import numpy as np
import pytest
import scipy.special

from bench.distributions import chi_square_above, gamma_median, student_above, student_degrees, student_quantile

DEGREES = [0.3, 1.0, 1.5, 2.0, 3.7, 10.0, 50.3, 79.9, 80.1, 507.0, 1e5]


@pytest.mark.parametrize("degrees", [*DEGREES, math.inf])
@pytest.mark.parametrize("share", [0.5, 0.6, 0.9, 0.95, 0.975, 0.9995, 0.999999])
def test_quantiles_of_student_are_those_of_scipy(degrees, share):
    assert student_quantile(degrees, share) == pytest.approx(
        scipy.special.stdtrit(degrees, share), rel=1e-10, abs=1e-15
    )


@pytest.mark.parametrize("degrees", [*DEGREES, math.inf])
def test_tails_of_student_are_those_of_scipy(degrees):
    values = np.array([-20.0, -1.0, -1e-3, 0.0, 1e-6, 0.3, 1.0, 2.0, 5.0, 12.0, 35.0])
    found = [student_above(degrees, value) for value in values]
    np.testing.assert_allclose(found, scipy.special.stdtr(degrees, -values), rtol=1e-10)


@pytest.mark.parametrize("share", [0.6, 0.9, 0.975, 0.9995])
def test_quantiles_of_one_and_two_degrees_are_closed_forms(share):
    """Cauchy's tan(pi*(p - 1/2)) and (2*p - 1)/sqrt(2*p*(1 - p))."""
    assert student_quantile(1.0, share) == pytest.approx(math.tan(math.pi * (share - 0.5)), rel=1e-12)
    assert student_quantile(2.0, share) == pytest.approx(
        (2 * share - 1) / math.sqrt(2 * share * (1 - share)), rel=1e-12
    )


@pytest.mark.parametrize("degrees", [0.3, 1.0, 3.7, 50.0, 500.0, 1e5])
def test_degrees_are_those_whose_quantile_it_is(degrees):
    found = student_degrees(0.975, student_quantile(degrees, 0.975))
    assert found == pytest.approx(degrees, rel=1e-6)
    assert student_quantile(found, 0.975) == pytest.approx(student_quantile(degrees, 0.975), rel=1e-12)


@pytest.mark.parametrize("degrees", [1.0, 2.0, 3.0, 17.0, 400.0])
def test_tails_of_chi_square_are_those_of_scipy(degrees):
    values = degrees * np.array([0.0, 1e-3, 0.3, 0.9, 1.0, 1.1, 1.5, 3.0, 20.0])
    found = [chi_square_above(degrees, value) for value in values]
    np.testing.assert_allclose(found, scipy.special.chdtrc(degrees, values), rtol=1e-10, atol=1e-300)


def test_of_two_degrees_chi_square_falls_as_an_exponential():
    assert chi_square_above(2.0, 7.0) == pytest.approx(math.exp(-3.5), rel=1e-13)


@pytest.mark.parametrize("shape", [0.5, 1.0, 2.3, 9.77, 100.0])
def test_medians_of_gamma_variables_are_those_of_scipy(shape):
    assert gamma_median(shape) == pytest.approx(scipy.special.gammaincinv(shape, 0.5), rel=1e-12)
