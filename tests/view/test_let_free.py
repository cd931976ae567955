"""A free-running model moves as an equation of motion that SciPy integrates here, without MuJoCo."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.diagnosis.model import holding_bandwidth
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.tracking import SoftTracking, track
from bench.trace.motion import measured_position
from bench.view.free_running import free_run, restarted, without_effects
from tests.diagnosis.test_commands import moving, only
from tests.fit.motions import RIG
from tests.view.motions import BALANCE, model_file

#: A tenth more inertia than `moving` has, its friction, and the rig's torque constant.
INERTIA, VISCOUS, COULOMB, K_T = 1.65e-3, 8e-4, 0.06, 0.8


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """A file with these."""
    return model_file(tmp_path_factory.mktemp("free") / "model.toml", (INERTIA, VISCOUS, COULOMB))


def one_way(seconds):
    """Never standing, so that friction has one sign."""
    return moving(lambda time: 40.0 + 20.0 * np.sin(4.4 * time) + 6.0 * np.sin(14.0 * time), seconds)


def integrated(trace, start, length):
    """Speed and way from a sample on - rad/s, rad - (length,)."""
    time, effort = trace.time, K_T * trace["current"]
    until = time[start : start + length]

    def slope(at, state):
        return [(np.interp(at, time, effort) - VISCOUS * state[0] - COULOMB) / INERTIA, state[0]]

    first = [trace["velocity"][start], 0.0]
    return solve_ivp(slope, (until[0], until[-1]), first, "RK45", until, rtol=1e-8, max_step=trace.sample_period).y


def test_it_is_as_far_off_as_the_equation_of_motion_says(model):
    trace = one_way(4.0)
    found = free_run(model, trace, RIG)
    assert (found.windows, found.time.size) == (5, 2000)
    off = []
    for start in range(0, 2001, 500):
        speed, way = integrated(trace, start, 2000)
        measured = trace["velocity"][start : start + 2000]
        gone = trace.sample_period * (np.cumsum(measured) - 0.5 * (measured + measured[0]))
        off.append((way - gone, speed - measured))
    position, velocity = np.sqrt(np.mean(np.square(off), axis=0))
    np.testing.assert_allclose(found.velocity, velocity, atol=0.03 * velocity.max())
    np.testing.assert_allclose(found.position, position, atol=0.03 * position.max())
    assert position[-1] > 0.5  # a tenth of the inertia is seen


def test_it_is_let_free_for_five_seconds_at_most(model):
    found = free_run(model, one_way(12.0), RIG)
    assert found.time[-1] == pytest.approx(5.0)
    assert found.windows == 6


def test_it_begins_anew_every_so_often_where_the_sensors_have_the_axis(model):
    trace = one_way(4.0)
    found = restarted(model, trace, RIG)
    assert list(found) == ["restarted every 0.5 s", "restarted every 1 s", "restarted every 2 s"]  # 5 s are not there
    for horizon, position in zip((0.5, 1.0, 2.0), found.values(), strict=True):
        length = round(horizon / trace.sample_period)
        np.testing.assert_allclose(position[::length], measured_position(trace)[::length], atol=1e-9)
        start = (len(trace) // length - 2) * length
        _, way = integrated(trace, start, length)
        gone = position[start : start + length] - position[start]
        np.testing.assert_allclose(gone, way, atol=2e-3 * np.ptp(way))


def test_without_what_was_found_it_is_held_where_it_is(tmp_path, model):
    """As the same axis that never had the effect."""
    trace = one_way(4.0)
    path = model_file(tmp_path / "model.toml", (INERTIA, VISCOUS, COULOMB), torque_offset={"torque": 0.02})
    found = without_effects(path, trace, RIG)
    without = AxisModel(AxisParameters(INERTIA, VISCOUS, COULOMB))
    plain = track(SoftTracking(without, trace, K_T * trace["current"]), holding_bandwidth(without, 66.0))
    np.testing.assert_allclose(found, plain.position, atol=1e-6)


def test_a_model_without_motion_is_not_let_free(tmp_path):
    (tmp_path / "model.toml").write_text(BALANCE, encoding="utf-8")
    blind = only(one_way(4.0), "velocity", "current")
    assert free_run(tmp_path / "model.toml", blind, RIG) is None
    assert restarted(tmp_path / "model.toml", blind, RIG) == {}
