"""Presliding friction: a spring for small motion, dry friction for large."""

import numpy as np
import pytest

from bench.validation.independent.effects import PreslidingFriction, StribeckFriction
from bench.validation.independent.plant import Plant
from tests.independent.axes import FREE, PLAIN, run


def test_small_motion_swings_on_the_bristles():
    stiffness = 50.0
    axis_level = PLAIN.coulomb
    plant = Plant([PLAIN], [[PreslidingFriction(stiffness, 0.0)]], velocity=1e-4)
    states = run(plant, 0.0, 0.2)
    w = states["velocity"][:, 0]
    turns = np.flatnonzero((w[1:] < 0) & (w[:-1] >= 0))
    period = np.diff(states["time"][turns]).mean()
    assert 2 * np.pi / period == pytest.approx(np.sqrt(stiffness / PLAIN.inertia), rel=2e-3)
    assert np.abs(states["position"]).max() < 0.01 * axis_level / stiffness


def test_it_leans_where_torque_over_stiffness_says_and_does_not_creep():
    damped = PreslidingFriction(50.0, 0.3)
    states = run(Plant([PLAIN], [[damped]]), lambda t: 0.01 - 0.01 * np.cos(np.pi * min(t / 0.15, 1.0)), 0.2)
    torque = 0.02 * PLAIN.torque_constant
    # dz/dt = w*(1 - z/z_max): z of the loading curve is z_max*(1 - exp(-q/z_max))
    limit = PLAIN.coulomb / 50.0
    assert states["position"][-1, 0] == pytest.approx(-limit * np.log1p(-torque / 50.0 / limit), rel=5e-3)
    assert abs(states["velocity"][-1, 0]) < 1e-6


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_sliding_it_is_dry_friction_at_the_level_others_set(direction):
    effects = [PreslidingFriction(20.0, 0.0), StribeckFriction(0.12, 20.0)]
    states = run(Plant([PLAIN], [effects], velocity=10.0 * direction), 0.3 * direction, 0.1)
    w = states["velocity"][:, 0]
    level = PLAIN.coulomb + 0.06 * np.exp(-((w / 20.0) ** 2))
    torque = 0.3 * direction * PLAIN.torque_constant - PLAIN.viscous * w - level * direction
    late = states["time"] > 0.03
    seen = np.gradient(w, states["time"])[late]
    assert np.abs(seen * PLAIN.inertia - torque[late]).max() < 2e-3 * PLAIN.coulomb


def test_without_a_level_there_is_no_friction():
    states = run(Plant([FREE], [[PreslidingFriction(20.0, 0.0)]], velocity=2.0), 0.0, 0.02)
    assert np.abs(states["velocity"] - 2.0).max() < 1e-6
