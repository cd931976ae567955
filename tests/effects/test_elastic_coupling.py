"""Two masses and a spring under a step of torque."""

import numpy as np
import pytest
from scipy.linalg import expm

from bench.effects.elastic_coupling import _driven
from bench.errors import InputError
from tests.effects.axes import AXIS, FREE, Present, moved, signals


def test_step_of_torque():
    """Motor speed: even acceleration of the whole, and the resonance sqrt(k*(1/J_m + 1/J_l)) on top."""
    time, _, velocity = signals(moved([Present.of("elastic_coupling", {"stiffness": 40.0})], 0.2, torque=0.5))
    motor, load = AXIS.rotor_inertia, AXIS.inertia - AXIS.rotor_inertia
    resonance = np.sqrt(40.0 * (1.0 / motor + 1.0 / load))
    swing = load / FREE.inertia * 0.5 / (motor * resonance)
    np.testing.assert_allclose(velocity, 0.5 * time / FREE.inertia + swing * np.sin(resonance * time), atol=0.02)


def test_damping_ends_the_swing():
    damped = Present.of("elastic_coupling", {"stiffness": 40.0, "damping": 0.1})
    time, _, velocity = signals(moved([damped], 0.5, torque=0.5))
    np.testing.assert_allclose((velocity - 0.5 * time / FREE.inertia)[-400:], 0.0, atol=1e-3)


def test_needs_a_load_beside_the_motor():
    with pytest.raises(InputError, match="motor's inertia"):
        moved([Present.of("elastic_coupling", {"stiffness": 40.0})], 0.1, parameters=type(FREE)(1e-3))


@pytest.mark.parametrize(("frequency", "damping"), [(300.0, 0.05), (300.0, 1.0), (1e3, 3.0), (1e5, 2000.0)])
def test_a_step_of_any_damping_is_exact(frequency, damping):
    """Against the matrix exponential: of much damping the terms of its closed form overflow, but not their product."""
    state = np.array([[0.0, 1.0], [-(frequency**2), -2.0 * damping * frequency]])
    driven, denominator = _driven(state, np.array([0.0, frequency**2]), 1e-3, np.ones((3, 5)))
    exact = expm(1e-3 * state)
    assert np.isfinite(driven).all()
    assert denominator == pytest.approx([1.0, -np.trace(exact), np.linalg.det(exact)], abs=1e-9)
