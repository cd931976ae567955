"""Bristles: energy along Dahl's curve, and no creep under half of the breakaway torque."""

from dataclasses import replace

import numpy as np

from tests.effects.axes import FREE, Present, moved, signals

DRY = replace(FREE, coulomb_friction=0.06)
DAHL = Present.of("presliding_friction", {"bristle_stiffness": 2.5})


def test_energy_along_dahls_curve():
    """From rest, friction builds up as K_0*(1 - exp(-sigma*x/K_0)); kinetic energy is work less its integral."""
    _, x, velocity = signals(moved([DAHL], 0.1, torque=0.15, parameters=DRY))
    depth = 0.06 / 2.5
    friction = 0.06 * (x - depth * -np.expm1(-x / depth))
    np.testing.assert_allclose(0.5 * FREE.inertia * velocity**2, 0.15 * x - friction, atol=1e-5)
    assert x[-1] > 5.0 * depth


def test_swings_but_does_not_creep_below_breakaway():
    """With damping it comes to rest where the bristles carry the torque."""
    damped = Present.of(DAHL.name, {"bristle_stiffness": 2.5, "bristle_damping": 0.05})
    _, position, velocity = signals(moved([damped], 2.0, torque=0.03, parameters=DRY))
    assert np.abs(velocity[-100:]).max() < 1e-3
    assert position[-1] < 0.06 / 2.5
