"""Amperes that differ between positive and negative current."""

import numpy as np
import pytest

from tests.effects.axes import FREE, VALUES, moved, present, signals
from tests.effects.damaged import HIDDEN, cut_off, diagnosed, inertia_holds, names, rounded, stale, uneven

NAME = "current_gain_asymmetry"


def test_acceleration_differs_between_the_signs_by_its_value():
    ends = [signals(moved([present(NAME)], 0.1, torque=torque))[2][-1] for torque in (0.5, -0.5)]
    mean = 0.5 * 0.1 / FREE.inertia
    assert ends[0] + ends[1] == pytest.approx(mean * VALUES[NAME]["gain_difference"], rel=1e-6)
    assert ends[0] - ends[1] == pytest.approx(2.0 * mean, rel=1e-6)


@pytest.mark.parametrize("single", HIDDEN)
def test_one_per_cent_gives_no_false_name(single):
    found = diagnosed(single or "null", uneven)
    assert names(found) - {NAME} == {single} - {None}
    for effect in found.effects:
        if effect.name == NAME:
            low, high = effect.parameters["gain_difference"].ci95
            assert low < -0.01 < high
            assert effect.effect.of_measurement
    assert inertia_holds(found)


@pytest.mark.parametrize("single", HIDDEN)
@pytest.mark.parametrize("damage", [cut_off, rounded, stale])
def test_coarse_and_stale_currents_give_no_false_name(single, damage):
    found = diagnosed(single or "null", damage)
    assert names(found) == {single} - {None}
    assert inertia_holds(found)


def test_a_null_is_left_without_a_name():
    assert np.isfinite(diagnosed("null").torque.noise_floor)
    assert diagnosed("null").verdict == "nothing_missing"
