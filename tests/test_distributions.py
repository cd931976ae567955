"""Student's t and chi-squared against scipy, whose special functions are Cephes' and Boost's, and closed forms."""

import math

import pytest
import scipy.special

from bench.distributions import chi_squared_tail, gamma_median, student_degrees, student_quantile, student_tail

DEGREES = [0.5, 1.0, 1.5, 2.0, 3.0, 8.3, 50.0, 333.0, 1999.0, 2001.0, 9999.0, 10001.0, 1e5]
PROBABILITIES = [0.01, 0.3, 0.5, 0.55, 0.9, 0.975, 0.9999]


@pytest.mark.parametrize("degrees", DEGREES)
def test_quantiles_and_tails_of_students_t_are_those_of_scipy(degrees):
    for probability in PROBABILITIES:
        expected = float(scipy.special.stdtrit(degrees, probability))
        assert student_quantile(degrees, probability) == pytest.approx(expected, rel=1e-10, abs=1e-12)
    for value in (-5.0, -0.1, 0.0, 0.5, 2.0, 20.0):
        expected = float(scipy.special.stdtr(degrees, -value))
        assert student_tail(degrees, value) == pytest.approx(expected, rel=1e-10)


def test_students_t_has_closed_forms_of_one_and_two_degrees():
    for value in (-3.0, 0.2, 1.0, 40.0):
        assert student_tail(1.0, value) == pytest.approx(0.5 - math.atan(value) / math.pi, rel=1e-12)
        assert student_tail(2.0, value) == pytest.approx(0.5 - value / (2.0 * math.sqrt(2.0 + value**2)), rel=1e-10)
    assert student_quantile(1.0, 0.975) == pytest.approx(math.tan(0.475 * math.pi), rel=1e-12)


def test_a_students_t_of_endless_degrees_is_normal():
    assert student_quantile(math.inf, 0.975) == pytest.approx(1.959963984540054, rel=1e-14)
    assert student_tail(math.inf, 1.0) == pytest.approx(0.15865525393145707, rel=1e-14)
    assert student_degrees(0.975, 1.9) == math.inf
    assert (student_tail(5.0, math.inf), student_tail(5.0, -math.inf)) == (0.0, 1.0)


@pytest.mark.parametrize("degrees", [0.7, 1.0, 4.5, 90.0, 2e4])
def test_degrees_are_those_of_which_the_quantile_is(degrees):
    assert student_degrees(0.975, student_quantile(degrees, 0.975)) == pytest.approx(degrees, rel=1e-8)


@pytest.mark.parametrize("degrees", DEGREES)
def test_the_tail_of_chi_squared_is_that_of_scipy(degrees):
    for share in (0.0, 0.01, 0.5, 1.0, 1.5, 4.0):
        expected = float(scipy.special.chdtrc(degrees, share * degrees))
        assert chi_squared_tail(degrees, share * degrees) == pytest.approx(expected, rel=1e-9, abs=1e-300)


def test_the_median_of_a_gamma_variable_is_that_of_scipy():
    assert gamma_median(1.0) == pytest.approx(math.log(2.0), rel=1e-14)
    for shape in (0.5, 2.57, 9.77, 40.0):
        assert gamma_median(shape) == pytest.approx(float(scipy.special.gammaincinv(shape, 0.5)), rel=1e-12)
