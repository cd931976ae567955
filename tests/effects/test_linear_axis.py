"""A linear axis takes the same effects, in metres and newtons."""

import numpy as np

from bench.axis_kind import LINEAR
from bench.effects.present import Present
from bench.plant.axis_model import AxisParameters
from tests.effects.axes import moved, signals

SLIDE = AxisParameters(3.0, motor_inertia=1.0, kind=LINEAR)


def test_two_masses_and_a_spring():
    spring = Present.of("elastic_coupling", {"stiffness": 1e4})
    time, _, velocity = signals(moved([spring], 0.5, torque=2.0, parameters=SLIDE))
    resonance = np.sqrt(1e4 * (1.0 / 1.0 + 1.0 / 2.0))
    swing = 2.0 / 3.0 * 2.0 / (1.0 * resonance)
    np.testing.assert_allclose(velocity, 2.0 * time / 3.0 + swing * np.sin(resonance * time), atol=1e-3)


def test_cogging_of_a_pole_pitch():
    """One period each 30 mm: kinetic energy is traded for magnetic energy."""
    pitch = 2.0 * np.pi / 0.03
    cogging = Present.of("cogging_torque", {"amplitude": 1.0, "harmonic": pitch})
    _, position, velocity = signals(moved([cogging], 1.0, velocity=0.2, parameters=SLIDE))
    energy = 0.5 * 3.0 * velocity**2 - 1.0 / pitch * np.cos(pitch * position)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-3)
    assert np.ptp(velocity) > 0.01
