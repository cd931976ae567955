"""Sensors: resolution, noise and simultaneity of what is recorded."""

import numpy as np
import pytest

from bench.axis_kind import LINEAR
from bench.errors import InputError
from bench.plant.axis_model import AxisParameters, build_spec
from bench.plant.plant import States
from bench.plant.sensing import Sensors
from bench.rig.motor import TorqueConstant
from tests.plant.open_loop import open_loop
from tests.plant.test_drive import reversals

SATURATING = TorqueConstant.from_datasheet(1.4, 1.8, 3.5, 5.7)


def motion(torque=None, n=8000):
    r = reversals(duration=n * 250e-6)
    torque = 1.2 * np.sin(7.0 * r.time) if torque is None else torque
    return States(r.time, r.position, r.velocity, torque, torque), r


def record(sensors, seed=0, torque=None):
    states, references = motion(torque)
    return states, sensors.record(states, references, np.random.default_rng(seed), "test")


def test_ideal_sensors_report_the_states():
    states, trace = record(Sensors(250e-6))
    np.testing.assert_array_equal(trace["position"], states.position)
    np.testing.assert_array_equal(trace["velocity"], states.velocity)
    assert trace.units["torque"] == "N*m"


def test_position_comes_in_counts():
    states, trace = record(Sensors(1e-3, encoder_resolution=1e-3))
    counts = trace["position"] / 1e-3
    assert np.abs(counts - np.round(counts)).max() < 1e-6
    assert np.abs(trace["position"] - states.position[::4]).max() <= 0.5e-3 * (1.0 + 1e-9)
    assert (trace["position"] - states.position[::4]).std() == pytest.approx(1e-3 / np.sqrt(12.0), rel=0.05)


def test_noise_has_the_stated_size_and_no_bias():
    constant = TorqueConstant(0.7)
    _, quiet = record(Sensors(250e-6, torque_constant=constant))
    _, trace = record(Sensors(250e-6, velocity_noise=0.03, current_noise=0.005, torque_constant=constant))
    for name, size in (("velocity", 0.03), ("current", 0.005)):
        error = trace[name] - quiet[name]
        assert error.std() == pytest.approx(size, rel=0.03)
        assert abs(error.mean()) < 4.0 * size / np.sqrt(len(error))


def test_current_inverts_the_saturating_torque_constant():
    states, trace = record(Sensors(1e-3, torque_constant=SATURATING), torque=np.full(8000, 3.2))
    np.testing.assert_allclose(SATURATING.torque(trace["current"]), states.torque[::4], rtol=1e-9)


def test_current_belongs_to_the_instant_of_the_row():
    """Torque is held over each tick at the value of a smooth signal in its middle: a row shows that signal."""
    period = 250e-6
    middles = (np.arange(8000) + 0.5) * period
    states, trace = record(Sensors(1e-3), torque=np.sin(60.0 * middles))
    error = trace["torque"] - np.sin(60.0 * states.time[::4])
    assert np.abs(error[1:]).max() < 2e-4
    assert abs(np.mean(error[1:] * np.cos(60.0 * states.time[4::4]))) < 1e-7  # neither early nor late


def test_current_never_exceeds_what_the_drive_set():
    torque = np.where(np.arange(8000) % 400 < 200, 3.5, -3.5)
    _, trace = record(Sensors(250e-6), torque=torque)
    assert np.abs(trace["torque"]).max() <= 3.5


def test_apparent_inertia_differs_from_the_true_one_only_by_the_hold():
    """|M|/(omega*|w|) of a sine: J*(1 - (omega*T)**2/24), as sampling a held torque has it; a plain mean loses more."""
    inertia, omega, period = 2.2e-3, 600.0, 250e-6
    parameters = AxisParameters(inertia)
    time = np.arange(8000) * period
    states = open_loop(build_spec(parameters, period), np.sin(omega * time))
    trace = Sensors(1e-3).record(states, motion()[1], np.random.default_rng(0), "test")
    mean = (states.torque[3:-1:4] + states.torque[4::4]) / 2.0

    def amplitude(signal, at):
        columns = np.stack([np.sin(omega * at), np.cos(omega * at), np.ones_like(at)], axis=1)
        return np.hypot(*np.linalg.lstsq(columns, signal)[0][:2])

    rows = trace.time[1:]
    speed = omega * amplitude(trace["velocity"][1:], rows) * inertia
    apparent, of_mean = amplitude(trace["torque"][1:], rows) / speed - 1.0, amplitude(mean, rows) / speed - 1.0
    hold = (omega * period) ** 2 / 24.0
    print(f"apparent inertia at {omega:g} rad/s: {apparent:+.2e}, by the mean {of_mean:+.2e}, hold alone {-hold:+.2e}")
    assert abs(apparent) < 1.6 * hold
    assert abs(of_mean) > 3.0 * hold


def test_linear_axes_record_force_in_newton():
    _, trace = record(Sensors(1e-3, kind=LINEAR))
    assert trace.units["force"] == "N"
    assert not trace.axis_kind.turns


def test_refuses_a_sample_period_off_the_ticks():
    with pytest.raises(InputError, match=r"sample_period: found 0\.0011 s; allowed: a multiple of the control period"):
        record(Sensors(1.1e-3))
