"""Friction that rises towards standstill: breakaway, and the time to stop."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from bench.effects.signals import Axis
from bench.effects.stribeck_friction import EFFECT
from tests.effects.axes import FREE, moved, present, signals
from tests.effects.recording import SCOPES

DRY = replace(FREE, coulomb_friction=0.06)


@pytest.mark.parametrize(("torque", "holds"), [(0.135, True), (0.145, False)])
def test_breaks_away_at_static_friction(torque, holds):
    _, _, velocity = signals(moved([present("stribeck_friction")], 0.5, torque=torque, parameters=DRY))
    assert (np.abs(velocity).max() < 1e-4) == holds


def test_time_to_stop():
    time, _, velocity = signals(moved([present("stribeck_friction")], 0.5, velocity=15.0, parameters=DRY))
    needed, _ = quad(lambda w: DRY.inertia / (0.06 + 0.08 * np.exp(-((w / 5.0) ** 2))), 0.0, 15.0)
    assert time[np.argmax(velocity < 1e-3)] == pytest.approx(needed, abs=2.5e-4)


def test_a_rise_ends_within_a_fifth_of_the_top_speed():
    """Weak drag without its name was met by rises of 0.20 to 0.29 of it."""
    scope = replace(SCOPES[0], top_speed=100.0)
    assert EFFECT.plausible([[0.08]], [(19.9,)], scope)
    assert not EFFECT.plausible([[0.08]], [(20.1,)], scope)
    assert not EFFECT.plausible([[0.08], [0.01]], [(19.9,), (20.1,)], scope)


@pytest.mark.parametrize(("rise", "coulomb", "sure"), [(0.08, 0.06, True), (0.08, 0.0, False), (0.0, 0.06, False)])
def test_a_rise_is_one_of_dry_friction_that_there_is_at_any_speed(rise, coulomb, sure):
    assert EFFECT.physical([rise], [5.0], Axis(1e-3, 0.0, coulomb)) is sure
