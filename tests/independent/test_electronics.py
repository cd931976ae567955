"""Winding, current loop and sensor against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from bench.validation.independent.effects import CurrentLoopLag, EncoderEccentricity, VelocityFilterLag, VoltageLimit
from bench.validation.independent.plant import Plant
from tests.independent.axes import FREE, PLAIN, run


def test_a_blocked_winding_charges_over_its_inductance():
    blocked = replace(PLAIN, coulomb=100.0)
    states = run(Plant([blocked], [[VoltageLimit(12.0)]]), 5.0, 0.01)
    exact = 3.0 * -np.expm1(-states["time"] * blocked.resistance / blocked.inductance)
    assert np.abs(states["current"][:, 0] - exact).max() < 1e-12


def test_within_its_voltage_the_current_is_what_is_demanded():
    blocked = replace(PLAIN, coulomb=100.0)
    states = run(Plant([blocked], [[VoltageLimit(12.0)]]), 1.0, 0.01)
    reached = -blocked.inductance / blocked.resistance * np.log1p(-1.0 / 3.0)
    late = states["time"] > reached + 20e-6
    assert np.abs(states["current"][late] - 1.0).max() < 1e-12


def test_no_load_speed_is_voltage_over_back_emf():
    light = replace(FREE, inertia=1e-5, rotor_inertia=5e-6)
    states = run(Plant([light], [[VoltageLimit(12.0)]]), 5.0, 0.1)
    assert states["velocity"][-1, 0] == pytest.approx(12.0 / light.back_emf_constant, rel=1e-6)


def test_lagging_torque_accelerates_as_a_first_order_lag():
    lag = 4e-3
    states = run(Plant([FREE], [[CurrentLoopLag(lag)]]), 1.0, 0.03)
    t = states["time"]
    exact = FREE.torque_constant / FREE.inertia * (t - lag * -np.expm1(-t / lag))
    assert (states["current"] == 1.0).all()
    assert np.abs(states["velocity"][:, 0] - exact).max() < 1e-4 * exact[-1]


def test_filtered_speed_lags_a_ramp_by_its_time_constant():
    lag = 4e-3
    states = run(Plant([FREE], [[VelocityFilterLag(lag)]]), 1.0, 0.03)
    t, slope = states["time"], FREE.torque_constant / FREE.inertia
    exact = slope * (t - lag * -np.expm1(-t / lag))
    assert np.abs(states["measured_velocity"][:, 0] - exact).max() < 1e-9
    assert np.abs(states["velocity"][:, 0] - slope * t).max() < 1e-9


def test_eccentric_encoder_errs_once_a_turn_and_its_speed_is_the_derivative():
    states = run(Plant([FREE], [[EncoderEccentricity(0.05, 0.4)]], velocity=40.0), 0.3, 0.2)
    q, seen = states["position"][:, 0], states["measured_position"][:, 0]
    assert np.abs(seen - q - 0.05 * np.sin(q + 0.4)).max() < 1e-12
    slope = np.gradient(seen, states["time"])[1:-1]
    assert np.abs(slope - states["measured_velocity"][1:-1, 0]).max() < 1e-4


def test_lag_and_eccentricity_compose_as_sensor_then_filter():
    effects = [VelocityFilterLag(2e-3), EncoderEccentricity(0.05, 0.4)]
    states = run(Plant([FREE], [effects], velocity=40.0), 0.0, 0.2)
    t = states["time"]
    late = t > 0.05
    angle = 40.0 * t + 0.4
    # steady sine through a first-order lag
    gain, delay = 1.0 / np.hypot(1.0, 40.0 * 2e-3), np.arctan(40.0 * 2e-3)
    exact = 40.0 + 40.0 * 0.05 * gain * np.cos(angle - delay)
    assert np.abs(states["measured_velocity"][:, 0] - exact)[late].max() < 1e-3
