"""The linearised model against the closed form of one and of two masses."""

import numpy as np
import pytest

from bench.effects.present import Present
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.linear import speed_over_torque

FREQUENCY = np.geomspace(0.5, 400.0, 60)
S = 2j * np.pi * FREQUENCY
MOTOR, LOAD, VISCOUS = 1e-3, 2e-3, 2e-3


def axis(*effects):
    return AxisModel(AxisParameters(MOTOR + LOAD, VISCOUS, 0.05, motor_inertia=MOTOR), effects)


def test_one_mass_is_one_over_inertia_and_viscous_friction():
    assert speed_over_torque(axis(), FREQUENCY) == pytest.approx(1.0 / ((MOTOR + LOAD) * S + VISCOUS), rel=3e-3)


def test_two_masses_have_an_antiresonance_and_a_resonance():
    stiffness, damping = LOAD * (2.0 * np.pi * 40.0) ** 2, 0.02
    coupling = Present.of("elastic_coupling", {"stiffness": stiffness, "damping": damping})
    between = damping + stiffness / S
    behind = between * LOAD * S / (between + LOAD * S)
    found = speed_over_torque(axis(coupling), FREQUENCY)
    assert found == pytest.approx(1.0 / (MOTOR * S + VISCOUS + behind), rel=5e-3)


def test_a_dead_zone_is_not_linear():
    backlash = Present.of("backlash", {"gap": 0.01, "contact_stiffness": 500.0, "contact_damping": 0.1})
    assert speed_over_torque(axis(backlash), FREQUENCY) is None
