"""Sensors: resolution, noise and simultaneity of what is recorded."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.plant.sensors import Sensors
from bench.plant.states import States
from bench.rig.torque_constant import TorqueConstant
from tests.plant.test_drive import reversals

SATURATING = TorqueConstant.from_datasheet(1.4, 1.8, 3.5, 5.7)


def motion(torque=None, n=8000):
    r = reversals(duration=n * 250e-6)
    torque = 1.2 * np.sin(7.0 * r.time) if torque is None else torque
    return States.of_one(r.time, r.position, r.velocity, torque), r


def record(sensors, seed=0, torque=None):
    states, references = motion(torque)
    return states, sensors.record(states, references, np.random.default_rng(seed), "test")


def test_ideal_sensors_report_the_states():
    states, trace = record(Sensors(250e-6))
    np.testing.assert_array_equal(trace["position"], states.position[:, 0])
    np.testing.assert_array_equal(trace["velocity"], states.velocity[:, 0])
    assert trace.units["torque"] == "N*m"


def test_position_comes_in_counts():
    states, trace = record(Sensors(1e-3, encoder_resolution=1e-3))
    counts = trace["position"] / 1e-3
    assert np.abs(counts - np.round(counts)).max() < 1e-6
    assert np.abs(trace["position"] - states.position[::4, 0]).max() <= 0.5e-3 * (1.0 + 1e-9)
    assert (trace["position"] - states.position[::4, 0]).std() == pytest.approx(1e-3 / np.sqrt(12.0), rel=0.05)


def test_noise_has_the_stated_size_and_no_bias():
    states, trace = record(
        Sensors(250e-6, velocity_noise=0.03, current_noise=0.005, torque_constant=TorqueConstant(0.7))
    )
    for error, size in (
        (trace["velocity"] - states.velocity[:, 0], 0.03),
        (trace["current"] - np.convolve(states.torque[:, 0] / 0.7, [0.5, 0.5])[:-1], 0.005),
    ):
        assert error[1:].std() == pytest.approx(size, rel=0.03)
        assert abs(error[1:].mean()) < 4.0 * size / np.sqrt(len(error))


def test_seed_alone_decides_the_noise():
    sensors = Sensors(1e-3, velocity_noise=0.03, current_noise=0.005)
    first, again, other = (record(sensors, seed)[1]["velocity"] for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def test_current_inverts_the_saturating_torque_constant():
    states, trace = record(Sensors(1e-3, torque_constant=SATURATING), torque=np.full(8000, 3.2))
    np.testing.assert_allclose(SATURATING.torque(trace["current"]), states.torque[::4, 0], rtol=1e-9)


def test_current_belongs_to_the_instant_of_the_row():
    """Torque is held between ticks; the row's current is its mean around the row, neither early nor late."""
    states, trace = record(Sensors(250e-6), torque=np.arange(8000.0))
    np.testing.assert_allclose(trace["torque"][1:], np.arange(1, 8000) - 0.5)
    assert len(states.time) == len(trace)


def test_linear_axes_record_force_in_newton():
    _, trace = record(Sensors(1e-3, linear=True))
    assert trace.units["force"] == "N"
    assert trace.linear


def test_refuses_a_sample_period_off_the_ticks():
    with pytest.raises(InputError, match=r"sample_period: found 0\.0011 s; allowed: a multiple of the control period"):
        record(Sensors(1.1e-3))
