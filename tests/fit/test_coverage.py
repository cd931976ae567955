"""A 95 % interval holds the truth in 95 % of recordings, also when residuals are correlated."""

import numpy as np
import pytest

from bench.fit.identify import identify
from tests.fit.motions import NAMES, RIG, Truth, recording


def coverage(count, seed, **what):
    rng, truth, inside = np.random.default_rng(seed), Truth(), []
    for _ in range(count):
        found = identify(recording(rng, truth, **what), RIG)
        inside.append(
            [
                found[name].ci95[0] <= value <= found[name].ci95[1]
                for name, value in zip(NAMES, truth.values, strict=True)
            ]
        )
    return np.mean(inside, axis=0)


@pytest.mark.parametrize("correlation", [0.0, 0.95])
def test_intervals_cover(correlation):
    share = coverage(60, 20, duration=2.0, correlation=correlation)
    print(f"\ncoverage of nominal 95 % at correlation {correlation}: {share} (J, viscous, Coulomb)")
    assert (share > 0.95 - 3.0 * np.sqrt(0.95 * 0.05 / 60)).all()


@pytest.mark.slow
@pytest.mark.parametrize("duration", [2.0, 6.0, 20.0])
@pytest.mark.parametrize("correlation", [0.0, 0.9, 0.95, 0.99])
def test_intervals_cover_over_many_recordings(duration, correlation):
    share = coverage(400, 21, duration=duration, correlation=correlation)
    print(f"\ncoverage of nominal 95 %, {duration:g} s, correlation {correlation}: {share} (J, viscous, Coulomb)")
    assert (share > 0.90).all()
