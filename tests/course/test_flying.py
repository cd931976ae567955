"""A class' throws scatter: no scatter of a launch may be taken for a mistake, and a mistaken flight is seen."""

import numpy as np
import pytest

from bench.course.catapult import SHIFTS, by_normal_equations, columns, compare_solvers
from bench.course.flights import contradiction

GRAVITY, HEIGHT, SPEED, ANGLE = 9.81, 0.46, 3.75, np.radians(45.0)


def throws(random, flights=10, points=20):
    """Ballistic throws (flights, points, 2) - m - as `simulation` has them: 1.5 % of the spring, 0.5 degrees, 4 mm."""
    speed = SPEED * np.sqrt(1.0 + 0.015 * random.standard_normal(flights))
    angle = ANGLE + np.radians(0.5) * random.standard_normal(flights)
    y, z = speed * np.cos(angle), speed * np.sin(angle)
    lands = (z + np.sqrt(z**2 + 2.0 * GRAVITY * (HEIGHT - 0.05))) / GRAVITY
    time = np.linspace(0.0, lands, points).T
    path = np.stack([y[:, None] * time, HEIGHT + z[:, None] * time - GRAVITY * time**2 / 2.0], axis=2)
    return path + 0.004 * random.standard_normal(path.shape)


def test_no_scatter_of_the_launch_is_a_mistake():
    """Of 1000 students none is flagged; at half the limit some five are, and a class of 40 fails one time in six."""
    random = np.random.default_rng(1)
    assert [found for found in (contradiction(throws(random)) for _ in range(1000)) if found] == []


def test_a_flight_counted_the_other_way_is_seen_in_every_draw():
    random = np.random.default_rng(2)
    for k in range(100):
        flights = throws(random)
        flights[k % 10][:, 0] *= -1.0
        assert contradiction(flights).endswith("its y is counted the other way")


def test_solvers_are_compared_where_the_normal_equations_are_singular_from_far_away():
    """Of 100 students one or two have such flights; their furthest distance has no path to compare."""
    random = np.random.default_rng(3)
    drawn = (np.round(np.concatenate(throws(random)), 4).T for _ in range(500))
    far = ((columns(y + SHIFTS[-1]), y, z) for y, z in drawn)
    matrix, y, z = next(each for each in far if np.linalg.det(each[0].T @ each[0]) == 0.0)
    with pytest.raises(np.linalg.LinAlgError):
        by_normal_equations(matrix, z)
    assert "1000 m away" in compare_solvers(y, z)
