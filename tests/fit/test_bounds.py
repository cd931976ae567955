"""Least squares within bounds, against scipy's."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from bench.fit.solution import bounded, solved


@pytest.mark.parametrize("correlated", [0.0, 0.9, 0.99])
def test_least_squares_within_bounds_is_that_of_a_general_solver(correlated):
    """Strongly correlated columns, where a bound that binds at first has to be released later."""
    rng, held = np.random.default_rng(1), 0
    for _ in range(250):
        size = int(rng.integers(2, 8))
        columns = rng.normal(size=(40, size)) * (1.0 - correlated) + correlated * rng.normal(size=(40, 1))
        columns *= 10.0 ** rng.uniform(-3.0, 3.0, size)
        effort = columns @ (rng.normal(size=size) / np.linalg.norm(columns, axis=0)) + rng.normal(scale=0.1, size=40)
        places = rng.permutation(size)[: int(rng.integers(1, size + 1))].tolist()
        scale = 1.0 / np.linalg.norm(columns, axis=0)
        limits = np.sort(rng.normal(size=(size, 2)), axis=1) * scale[:, None]
        low, high = np.full(size, -np.inf), np.full(size, np.inf)
        low[places], high[places] = limits[places].T
        gram, noise = columns.T @ columns, np.zeros((size, size))
        bounds = dict(zip(places, zip(low[places].tolist(), high[places].tolist(), strict=True), strict=True))
        theta, at = bounded(gram, columns.T @ effort, noise, bounds)
        best = lsq_linear(columns * scale, effort, (low / scale, high / scale), method="bvls", tol=1e-14)
        assert (theta >= low).all() and (theta <= high).all()
        assert np.sum((effort - columns @ theta) ** 2) <= 2.0 * best.cost * (1.0 + 1e-9)
        assert all(theta[place] in bounds[place] for place in at)
        held += bool(at)
    assert held > 100


def test_a_column_whose_squares_underflow_explains_nothing():
    columns = np.random.default_rng(0).standard_normal((100, 2)) * [1.0, 1e-160]
    effort = 3.0 * columns[:, 0]
    theta, _ = solved(columns.T @ columns, columns.T @ effort, np.zeros((2, 2)))
    assert theta == pytest.approx([3.0, 0.0])
