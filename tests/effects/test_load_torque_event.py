"""Short pushes are told by themselves from what else runs slowly."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from bench.effects.load_torque_event import EFFECT


def left(time, pushes, other, noise=0.02):
    """Of a fit that lacks some pushes - N*m, s, s - and another torque (n,): what `apart` asks of it."""
    rng = np.random.default_rng(3)
    values = gaussian_filter1d(noise / 0.38 * rng.standard_normal(time.size), 2.0) + other
    values += sum(torque * ((time >= start) & (time < stop)) for torque, start, stop in pushes)
    return SimpleNamespace(time=time, residual=values, scope=SimpleNamespace(width=2e-3))


TIME = np.arange(10_000) * 1e-3
SLOW = 0.12 * np.sin(2.0 * np.pi * 0.7 * TIME) + 0.08 * np.sin(2.0 * np.pi * 1.9 * TIME + 1.0)


@pytest.mark.parametrize("other", [0.0 * TIME, SLOW])
@pytest.mark.parametrize("pushes", [[(0.5, 3.0, 3.05)], [(-0.7, 4.0, 4.1), (0.6, 7.2, 7.27)]])
def test_short_ones_are_distinguished_by_themselves_from_what_runs_slowly(pushes, other):
    found = sorted(EFFECT.apart(left(TIME, pushes, other)))
    assert len(found) == len(pushes)
    for (shape, around), (_, start, stop) in zip(found, pushes, strict=True):
        np.testing.assert_allclose(shape, (start, stop), atol=4e-3)
        assert around[0] < start < stop < around[1]


@pytest.mark.parametrize(
    "pushes",
    [
        [],  # nothing
        [(0.6 * (-1) ** k, 0.5 + 0.4 * k, 0.56 + 0.4 * k) for k in range(20)],  # at every reversal
        [(0.6 * 0.8**k, 0.5 + k, 0.56 + k) for k in range(9)],  # each a little weaker
        [(0.6, 3.0, 4.5)],  # too long to be distinguished from what else varies
    ],
)
def test_none_where_nothing_stands_out(pushes):
    assert not EFFECT.apart(left(TIME, pushes, SLOW))


def test_none_across_a_gap_in_the_rows():
    """What a stretch would reach over is not there: rows around a reversal are not used."""
    kept = (TIME < 3.0) | (TIME > 3.05)
    fitted = left(TIME, [(0.5, 2.99, 3.06)], SLOW)
    cut = SimpleNamespace(time=TIME[kept], residual=fitted.residual[kept], scope=fitted.scope)
    assert not EFFECT.apart(cut)
