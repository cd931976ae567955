"""Student's t and chi-squared without scipy, whose special functions take 0.3 s of a command to import.

    P(a, x) = x**a*exp(-x)/Gamma(a + 1)*(1 + x/(a + 1) + x**2/((a + 1)*(a + 2)) + ...)
    I_x(a, b) = x**a*(1 - x)**b/(a*B(a, b))/(1 + d_1/(1 + d_2/(1 + ...)))

Regularised incomplete gamma and beta functions, and of both the continued fractions that converge where a series or
the other argument does not. Source: NIST Digital Library of Mathematical Functions, 8.7, 8.9 and 8.17.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import cache
from itertools import count
from statistics import NormalDist

#: Degrees of freedom from which four terms of an expansion in their inverse give Student's quantile to 1e-15.
MANY = 1e4
#: First argument of a beta function from which the next term of a series in its inverse is below 1e-17.
LARGE = 1e3
#: Degrees of freedom beyond which a Student's t is a normal distribution.
NORMAL = 1e9
#: Relative change at which an iteration has converged, and a number that stands for zero in a denominator.
PRECISE, TINY = 1e-16, 1e-300


def student_tail(degrees: float, value: float) -> float:
    """Probability that a Student's t of these degrees of freedom exceeds a value."""
    if not degrees < NORMAL:
        return 0.5 * math.erfc(value / math.sqrt(2.0))
    if math.isinf(value):
        return 0.0 if value > 0.0 else 1.0
    a, square = 0.5 * degrees, value * value
    x, rest = degrees / (degrees + square), square / (degrees + square)
    scale = math.exp(-a * math.log1p(square / degrees) - _log_beta(a)) * math.sqrt(rest)
    if x <= (a + 1.0) / (a + 2.5):
        both = scale / a / _continued(1.0, ((each, 1.0) for each in _of_beta(a, 0.5, x)))
    else:
        both = 1.0 - 2.0 * scale / _continued(1.0, ((each, 1.0) for each in _of_beta(0.5, a, rest)))
    return 0.5 * both if value >= 0.0 else 1.0 - 0.5 * both


def student_quantile(degrees: float, probability: float) -> float:
    """Value that a Student's t of these degrees of freedom stays below with this probability."""
    if probability < 0.5:
        return -student_quantile(degrees, 1.0 - probability)
    normal = NormalDist().inv_cdf(probability)
    if not degrees < NORMAL or normal == 0.0:
        return normal
    start = _expanded(degrees, normal)
    return start if degrees >= MANY else _refined(degrees, 1.0 - probability, start)


def student_degrees(probability: float, value: float) -> float:
    """Degrees of freedom of the Student's t whose quantile of this probability - above one half - is a value.

    inf where that is no larger than a normal distribution's.
    """
    low, high = -10.0, math.log(NORMAL)  # of the logarithm
    if student_tail(NORMAL, value) >= 1.0 - probability:
        return math.inf
    return math.exp(_root(lambda each: student_tail(math.exp(each), value) - (1.0 - probability), low, high))


def chi_squared_tail(degrees: float, value: float) -> float:
    """Probability that a chi-squared variable of these degrees of freedom exceeds a value."""
    return 1.0 if value <= 0.0 else _gamma_tail(0.5 * degrees, 0.5 * value)


@cache
def gamma_median(shape: float) -> float:
    """Median of a gamma variable of unit scale."""
    return _root(lambda each: _gamma_tail(shape, each) - 0.5, TINY, shape + 1.0)


def _root(falling: Callable[[float], float], low: float, high: float) -> float:
    """Where a falling function passes zero, by regula falsi that halves the weight of an end that stays (Illinois)."""
    below, above = falling(low), falling(high)
    side, middle = 0, low
    for _ in range(200):
        middle = (low * above - high * below) / (above - below) if above != below else 0.5 * (low + high)
        if not low < middle < high or high - low <= 4.0 * PRECISE * abs(middle):
            return middle
        found = falling(middle)
        if found == 0.0:
            return middle
        if found > 0.0:
            low, below, above = middle, found, 0.5 * above if side > 0 else above
        else:
            high, above, below = middle, found, 0.5 * below if side < 0 else below
        side = 1 if found > 0.0 else -1
    return middle


def _expanded(degrees: float, z: float) -> float:
    """Student's quantile from the normal one (Abramowitz and Stegun, 26.7.5)."""
    terms = (
        (z**3 + z) / 4.0,
        (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / 96.0,
        (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / 384.0,
        (79.0 * z**9 + 776.0 * z**7 + 1482.0 * z**5 - 1920.0 * z**3 - 945.0 * z) / 92160.0,
    )
    return z + sum(term / degrees ** (power + 1) for power, term in enumerate(terms))


def _refined(degrees: float, tail: float, value: float) -> float:
    """Value that a Student's t exceeds with this probability, by Newton's method on logarithms from a first guess."""
    log_scale = -_log_beta(0.5 * degrees) - 0.5 * math.log(degrees)
    for _ in range(100):
        left = student_tail(degrees, value)
        density = math.exp(log_scale - 0.5 * (degrees + 1.0) * math.log1p(value * value / degrees))
        step = left / (value * density) * math.log(left / tail)
        value *= math.exp(step)
        if abs(step) <= 1e-9:  # the next one is of its square
            break
    return value


def _gamma_tail(shape: float, value: float) -> float:
    """1 - P(a, x)."""
    scale = math.exp(shape * math.log(value) - value - math.lgamma(shape + 1.0))
    if value < shape + 1.0:
        total = term = 1.0
        for k in count(1):
            term *= value / (shape + k)
            total += term
            if term <= PRECISE * total:
                return 1.0 - scale * total
    first = value + 1.0 - shape
    fraction = _continued(first, ((k * (shape - k), first + 2.0 * k) for k in count(1)))
    return scale * shape / fraction


def _log_beta(a: float) -> float:
    """ln B(a, 1/2), of a large argument by Stirling's series of the difference, which loses no digits."""
    if a < LARGE:
        return math.lgamma(a) + math.lgamma(0.5) - math.lgamma(a + 0.5)
    return 0.5 * math.log(math.pi / a) + 1.0 / (8.0 * a) - 1.0 / (192.0 * a**3)


def _of_beta(a: float, b: float, x: float) -> Iterator[float]:
    """The numerators d_1, d_2, ... of the beta function's continued fraction."""
    for m in count():
        yield -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        yield (m + 1.0) * (b - m - 1.0) * x / ((a + 2.0 * m + 1.0) * (a + 2.0 * m + 2.0))


def _continued(first: float, terms: Iterator[tuple[float, float]]) -> float:
    """first + n_1/(d_1 + n_2/(d_2 + ...)) by Lentz's method; the terms are pairs of n and d."""
    value = ahead = first or TINY
    behind = 0.0
    for numerator, denominator in terms:
        behind = 1.0 / (denominator + numerator * behind or TINY)
        ahead = denominator + numerator / ahead or TINY
        value *= ahead * behind
        if abs(ahead * behind - 1.0) <= 2.0 * PRECISE:
            break
    return value
