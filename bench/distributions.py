"""Quantiles and tails of Student's t, and of chi-square, for numbers; `scipy.special` takes 0.25 s of CPU to import.

    P(T > t) = I(x; nu/2, 1/2)/2,   x = nu/(nu + t**2)
    P(chi2 > c) = Q(nu/2, c/2)

I, Q - regularised incomplete beta and upper gamma function; nu - degrees of freedom, inf for a normal distribution.
Both are continued fractions, which converge on one side of the mean; the other side is the complement.
Source: NIST Digital Library of Mathematical Functions, 8.9, 8.11.4, 8.17.22.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from itertools import count
from statistics import NormalDist

#: Relative change at which a continued fraction or a series has converged, and a step of Newton's at which the next one
#: would be rounding.
CONVERGED, LAST = 4e-16, 1e-8
#: Half degrees of freedom from which a series of Gamma(a + 1/2)/Gamma(a) is more precise than the functions themselves.
LARGE = 40.0
#: Turns of a search of degrees of freedom, and the logarithms between which they are.
TURNS, LEAST, MOST = 60, -7.0, 30.0
NORMAL = NormalDist()


def student_quantile(degrees: float, share: float) -> float:
    """Value below which a share, from 1/2 to 1, of Student's t lies.

    Newton's steps of the logarithms of value and tail, from the series around the normal distribution (M. Abramowitz,
    I. A. Stegun, Handbook of Mathematical Functions, 26.7.5).
    """
    z = NORMAL.inv_cdf(share)
    if math.isinf(degrees) or z <= 0.0:
        return z
    wider = (z**3 + z) / 4.0, (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / 96.0
    value = z + wider[0] / degrees + wider[1] / degrees**2
    value += (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / (384.0 * degrees**3)
    step = 1.0
    while abs(step) > LAST:
        above = student_above(degrees, value)
        step = math.log(above / (1.0 - share)) * above / (_density(degrees, value) * value)
        value *= math.exp(step)
    return float(value)


def student_above(degrees: float, value: float) -> float:
    """Probability of more than a value of Student's t."""
    if value < 0.0:
        return 1.0 - student_above(degrees, -value)
    if math.isinf(degrees):
        return 0.5 * math.erfc(value / math.sqrt(2.0))
    half, square = 0.5 * degrees, value * value
    x, y = degrees / (degrees + square), square / (degrees + square)
    power = math.exp(_ratio(half) - 0.5 * math.log(math.pi) - half * math.log1p(square / degrees)) * math.sqrt(y)
    if x < (half + 1.0) / (half + 2.5):
        return 0.5 * power / half / _fraction(_of_beta(x, half, 0.5))
    return 0.5 - power / _fraction(_of_beta(y, 0.5, half))


def student_degrees(share: float, value: float) -> float:
    """Degrees of freedom of the Student's t of which a share lies below a value."""
    low, high = LEAST, MOST
    for _ in range(TURNS):
        middle = 0.5 * (low + high)
        wide = student_above(math.exp(middle), value) > 1.0 - share
        low, high = (middle, high) if wide else (low, middle)
    return math.exp(0.5 * (low + high))


def chi_square_above(degrees: float, value: float) -> float:
    """Probability of more than a value, not below zero, of chi-square."""
    return _gamma_above(0.5 * degrees, 0.5 * value)


@lru_cache(maxsize=64)
def gamma_median(shape: float) -> float:
    """Median of a gamma variable of a shape, of scale one."""
    value, step = shape - 1.0 / 3.0, 1.0
    while abs(step) > LAST * value:
        density = math.exp((shape - 1.0) * math.log(value) - value - math.lgamma(shape))
        step = (_gamma_above(shape, value) - 0.5) / density
        value += step
    return value


def _density(degrees: float, value: float) -> float:
    """Of Student's t."""
    falls = 0.5 * (degrees + 1.0) * math.log1p(value * value / degrees)
    return math.exp(_ratio(0.5 * degrees) - falls) / math.sqrt(degrees * math.pi)


def _ratio(a: float) -> float:
    """Logarithm of Gamma(a + 1/2)/Gamma(a)."""
    if a < LARGE:
        return math.lgamma(a + 0.5) - math.lgamma(a)
    terms = (1.0, -1.0 / 8.0, 1.0 / 128.0, 5.0 / 1024.0, -21.0 / 32768.0, -399.0 / 262144.0)
    return 0.5 * math.log(a) + math.log(sum(term / a**k for k, term in enumerate(terms)))


def _gamma_above(a: float, x: float) -> float:
    """Regularised upper incomplete gamma function Q(a, x)."""
    if x <= 0.0:
        return 1.0
    power = math.exp(a * math.log(x) - x - math.lgamma(a))
    if x > a + 1.0:
        return power / _fraction(_of_gamma(x, a))
    term = total = 1.0 / a
    for k in count(1):
        term *= x / (a + k)
        total += term
        if not term > CONVERGED * total:
            break
    return 1.0 - power * total


def _of_beta(x: float, a: float, b: float) -> Iterator[tuple[float, float]]:
    """Partial numerators and denominators of the incomplete beta function's continued fraction."""
    yield 1.0, 1.0
    for k in count():
        yield -(a + k) * (a + b + k) * x / ((a + 2 * k) * (a + 2 * k + 1.0)), 1.0
        yield (k + 1) * (b - k - 1.0) * x / ((a + 2 * k + 1.0) * (a + 2 * k + 2.0)), 1.0


def _of_gamma(x: float, a: float) -> Iterator[tuple[float, float]]:
    """The same of the upper incomplete gamma function."""
    yield 1.0, x + 1.0 - a
    for k in count(1):
        yield -k * (k - a), x + 2.0 * k + 1.0 - a


def _fraction(terms: Iterator[tuple[float, float]]) -> float:
    """b_0 + a_1/(b_1 + a_2/(b_2 + ...)) of terms (a_k, b_k), by Lentz's method."""
    (_, found), last = next(terms), 0.0
    upper = found
    for numerator, denominator in terms:
        last = 1.0 / (denominator + numerator * last)
        upper = denominator + numerator / upper
        found *= upper * last
        if not abs(upper * last - 1.0) > CONVERGED:  # as of what is no number
            break
    return found
