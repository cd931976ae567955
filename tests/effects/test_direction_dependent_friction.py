"""Friction that differs between directions: decelerations, and what holds at rest."""

from dataclasses import replace

import numpy as np
import pytest

from tests.effects.axes import FREE, Present, moved, signals

DRY = replace(FREE, coulomb_friction=0.06)
ONLY_DRY = Present.of("direction_dependent_friction", {"coulomb_difference": 0.05})


@pytest.mark.parametrize("velocity", [30.0, -30.0])
def test_deceleration_of_each_direction(velocity):
    time, _, found = signals(moved([ONLY_DRY], 0.2, velocity=velocity, parameters=DRY))
    level = 0.06 + np.sign(velocity) * 0.025
    np.testing.assert_allclose(found, velocity - np.sign(velocity) * level * time / DRY.inertia, atol=1e-9)


@pytest.mark.parametrize("viscous", [0.0, 1e-9])
@pytest.mark.parametrize(("torque", "holds"), [(0.08, True), (0.09, False), (-0.03, True), (-0.04, False)])
def test_holds_up_to_the_level_of_each_direction(torque, holds, viscous):
    """Natively, and step by step where there is a viscous difference."""
    effect = Present.of(ONLY_DRY.name, {"coulomb_difference": 0.05, "viscous_difference": viscous})
    _, _, velocity = signals(moved([effect], 0.5, torque=torque, parameters=DRY))
    assert (np.abs(velocity).max() < 1e-4) == holds


def test_viscous_difference_drives_one_way_and_brakes_the_other():
    effect = Present.of("direction_dependent_friction", {"coulomb_difference": 0.0, "viscous_difference": 2e-3})
    time, _, velocity = signals(moved([effect], 1.0, velocity=30.0))
    np.testing.assert_allclose(velocity, 30.0 * np.exp(-1e-3 * time / FREE.inertia), rtol=1e-6)


def test_a_level_below_zero_is_none():
    """A difference beyond twice the friction leaves one direction free."""
    effect = Present.of("direction_dependent_friction", {"coulomb_difference": 0.2})
    _, _, velocity = signals(moved([effect], 0.1, velocity=-30.0, parameters=DRY))
    np.testing.assert_allclose(velocity, -30.0, atol=1e-9)


def test_both_ways_to_simulate_agree():
    native = signals(moved([ONLY_DRY], 0.5, velocity=5.0, torque=0.03, parameters=DRY))
    ticked = signals(
        moved(
            [ONLY_DRY, Present.of("load_dependent_friction", {"load_friction_coefficient": 1e-12})],
            0.5,
            velocity=5.0,
            torque=0.03,
            parameters=DRY,
        )
    )
    np.testing.assert_allclose(native[2], ticked[2], atol=1e-6)
