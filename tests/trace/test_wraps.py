"""By how much an encoder's register jumps: a power of two of counts where a count is known, else as measured."""

import numpy as np
import pytest

from bench.trace.wraps import period_of


def jumping(period, noise, seed=0):
    """A position that turns on evenly inside a period, and where it jumps."""
    on = 0.01 * period * np.arange(2000)
    position = np.mod(on, period) + noise * np.random.default_rng(seed).standard_normal(on.size)
    return position, np.flatnonzero(np.abs(np.diff(position)) > 0.5 * period)


@pytest.mark.parametrize("power", [8, 12, 16])
def test_a_register_holds_a_power_of_two_of_counts(power):
    count = 1e-3
    found = period_of(*jumping(count * 2.0**power, 0.2 * count), count)
    assert found == count * 2.0**power


def test_a_period_without_a_known_count_is_the_turn_that_is_nearest_or_as_measured():
    assert period_of(*jumping(2.0 * np.pi, 1e-3)) == 2.0 * np.pi
    assert period_of(*jumping(1.7, 1e-4)) == pytest.approx(1.7, rel=1e-3)


@pytest.mark.parametrize(("short", "alike"), [(0.01, True), (0.3, False)])
def test_jumps_of_which_one_is_shorter_have_no_period(short, alike):
    position, places = jumping(1.7, 0.0)
    turn = slice(places[3] + 1, places[4] + 1)
    position[turn] = np.maximum(position[turn], short * 1.7)
    assert (period_of(position, places) is not None) is alike
