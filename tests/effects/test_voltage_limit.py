"""Current under limited voltage: closed forms of the winding, and the speed that voltage allows."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.voltage_limit import EFFECT
from tests.effects.axes import AXIS, WINDING, Present, model, moved, signals

STEP = 1e-3


def flowing(demand, before, velocity, voltage=40.0):
    values = {"voltage": np.array([voltage])}
    arrays = (np.array([float(value)]) for value in (velocity, demand * 0.7, before * 0.7))
    mean, end = EFFECT.flowing(values, model().axis, *arrays, STEP)
    return mean[0] / 0.7, end[0] / 0.7


def test_full_voltage_until_the_demand_is_reached():
    """At rest from zero: i = U/R*(1 - exp(-t/tau)), held once it is what is wanted."""
    tau = AXIS.inductance / AXIS.resistance
    reached = -tau * np.log(1.0 - 2.0 * 4.0 / 40.0)
    rising = 10.0 * (reached - tau * (1.0 - np.exp(-reached / tau)))
    assert flowing(2.0, 0.0, 0.0) == pytest.approx(((rising + 2.0 * (STEP - reached)) / STEP, 2.0))


def test_beyond_the_limit_current_tends_to_what_is_left():
    """The back-EMF of 50 rad/s leaves 5 V of 40, which is 1.25 A in the end."""
    tau = AXIS.inductance / AXIS.resistance
    end = 1.25 * (1.0 - np.exp(-STEP / tau))
    assert flowing(4.0, 0.0, 50.0)[1] == pytest.approx(end)
    assert flowing(-2.0, 0.0, 50.0)[1] == pytest.approx(-2.0)


def test_enough_voltage_changes_nothing_but_the_rise():
    assert flowing(2.0, 2.0, 10.0) == pytest.approx((2.0, 2.0))


def test_top_speed_is_that_of_the_voltage():
    """Without friction the current ends at zero: U = K_e*omega. What is reported is what flows."""
    states = moved([Present.of("voltage_limit", {"voltage": 36.0})], 1.0, torque=1.5)
    _, _, velocity = signals(states)
    assert velocity[-1] == pytest.approx(36.0 / WINDING.back_emf_constant, rel=1e-3)
    np.testing.assert_allclose(states.torque, states.motor_torque, atol=1e-12)
    assert abs(states.torque[-1, 0]) < 0.05


def test_a_winding_without_inductance_jumps():
    effect = replace(model().axis, winding=replace(WINDING, inductance=0.0))
    one = np.ones(1)
    mean, end = EFFECT.flowing({"voltage": 40.0 * one}, effect, 0.0 * one, 0.7 * one, 0.0 * one, STEP)
    assert (mean[0], end[0]) == pytest.approx((0.7, 0.7))
