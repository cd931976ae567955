"""Elastic coupling: natural frequency, decay and antiresonance of the two-mass axis."""

import numpy as np
import pytest

from bench.validation.independent.effects import ElasticCoupling
from bench.validation.independent.plant import Plant
from tests.cases import parameters
from tests.independent.axes import FREE, run

ROTOR, LOAD = FREE.rotor_inertia, FREE.inertia - FREE.rotor_inertia
REDUCED = ROTOR * LOAD / FREE.inertia


def test_motor_and_load_swing_at_the_natural_frequency_and_decay():
    stiffness, damping = 45.0, 0.004
    plant = Plant([FREE], [[ElasticCoupling(stiffness, damping)]])
    plant.velocity[:], plant.load_velocity[:] = 3.0, -3.0 * ROTOR / LOAD
    states = run(plant, 0.0, 0.12)
    relative = (states["velocity"] - states["load_velocity"])[:, 0]
    omega, decay = np.sqrt(stiffness / REDUCED), damping / (2.0 * REDUCED)
    swing = np.sqrt(omega**2 - decay**2)
    t = states["time"]
    exact = relative_start = 3.0 * (1.0 + ROTOR / LOAD)
    exact = relative_start * np.exp(-decay * t) * (np.cos(swing * t) - decay / swing * np.sin(swing * t))
    assert np.abs(relative - exact).max() < 2e-3 * relative_start


def test_truth_names_the_resonance():
    effect = ElasticCoupling(45.0, 0.004)
    assert parameters(effect, FREE)["resonance_frequency"] == pytest.approx(np.sqrt(45.0 / REDUCED) / (2.0 * np.pi))


def test_at_the_antiresonance_the_motor_stands_still():
    stiffness = 45.0
    antiresonance = np.sqrt(stiffness / LOAD)
    amplitude = 0.1 * FREE.torque_constant
    # load swinging so that the spring holds the motor against its torque: the motor has no reason to move
    plant = Plant([FREE], [[ElasticCoupling(stiffness, 0.0)]])
    plant.load_position[:], plant.load_velocity[:] = 0.0, -amplitude / stiffness * antiresonance
    states = run(plant, lambda t: 0.1 * np.sin(antiresonance * t), 0.1)
    assert np.abs(states["velocity"]).max() < 1e-3 * np.abs(states["load_velocity"]).max()
