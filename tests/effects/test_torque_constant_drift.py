"""Torque per ampere that changes: acceleration under a constant current changes with it."""

import numpy as np
import pytest

from tests.effects.axes import FREE, VALUES, moved, present, signals
from tests.effects.damaged import AXIS, HIDDEN, diagnosed, drifting, inertia_holds, names

NAME = "torque_constant_drift"


def test_acceleration_changes_in_proportion_to_time():
    time, _, velocity = signals(moved([present(NAME)], 0.4, torque=0.5))
    exact = 0.5 / FREE.inertia * (time + 0.5 * VALUES[NAME]["rate"] * time**2)
    np.testing.assert_allclose(velocity, exact, rtol=1e-6, atol=1e-3)


@pytest.mark.parametrize("single", HIDDEN)
def test_a_gain_that_drifts_by_two_per_cent_is_no_load_torque_event(single):
    found = diagnosed(single or "null", drifting)
    assert names(found) - {NAME} == {single} - {None}
    assert inertia_holds(found)


def test_inertia_holds_by_the_constant_of_any_moment():
    """Right at the start, in the middle or at the end: the rig does not say when its torque constant holds."""

    def right_in_the_middle(current, time):
        return drifting(current, time) / 1.01

    for damage in (drifting, right_in_the_middle):
        found = diagnosed("null", damage)
        assert names(found) == {NAME}
        low, high = found.parameters["moment_of_inertia"].ci95
        assert low < AXIS.inertia < high
