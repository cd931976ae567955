"""A class' throws scatter: no scatter of a launch may be taken for a mistake, and a mistaken flight is seen."""

import numpy as np
import pytest

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


@pytest.mark.parametrize("students", [150, pytest.param(1000, marks=pytest.mark.slow)])
def test_no_scatter_of_the_launch_is_a_mistake(students):
    """Of 1000 students none is flagged; at half the limit some five are, and a class of 40 fails one time in six."""
    random = np.random.default_rng(1)
    assert [found for found in (contradiction(throws(random)) for _ in range(students)) if found] == []


@pytest.mark.parametrize("draws", [20, pytest.param(100, marks=pytest.mark.slow)])
def test_a_flight_counted_the_other_way_is_seen_in_every_draw(draws):
    random = np.random.default_rng(2)
    for k in range(draws):
        flights = throws(random)
        flights[k % 10][:, 0] *= -1.0
        assert contradiction(flights).endswith("its y is counted the other way")
