"""What a recording was made under, against closed forms; and from where on another motion is one."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.baseline.observe import _torque_gap, conditions, motion_ratio, unlike
from bench.comparison.difference import Measured
from bench.rig.rig import Rig
from bench.trace.trace import Trace

RIG = Rig.of({"name": "a", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A"}})
SPEED, OMEGA = 20.0, 2.0 * np.pi * 0.5


def recorded(duration, glitch=0.0):
    time = 7.0 + 1e-3 * np.arange(round(1000.0 * duration) + 1)
    speed = SPEED * np.sin(OMEGA * (time - time[0]))
    speed[100] += glitch
    signals = {"velocity": speed, "current": np.full(time.size, 0.5)}
    return Trace(time, signals, {"velocity": "rad/s", "current": "A"}, "a sine")


def test_a_sines_conditions_are_those_of_its_formula():
    found = {name: one.value for name, one in conditions([recorded(4.0)], RIG, 80.0).items()}
    assert found["top_speed"] == pytest.approx(SPEED * np.sin(0.5 * np.pi * 0.99), rel=1e-3)  # 99 of 100 lie below
    assert found["rms_speed"] == pytest.approx(SPEED / np.sqrt(2.0), rel=1e-3)
    assert found["rms_acceleration"] == pytest.approx(SPEED * OMEGA / np.sqrt(2.0), rel=5e-3)
    assert (found["rms_effort"], found["duration"]) == (pytest.approx(0.4), pytest.approx(4.0))
    assert (found["sample_period"], found["cutoff"]) == (pytest.approx(1e-3), 80.0)


def test_a_speed_that_is_sampled_more_slowly_than_it_would_be_smoothed_is_not():
    """Differences over two periods of T lessen the acceleration of a sine by sin(w*T)/(w*T), and nothing else does."""
    period, omega = 0.03, 2.0 * np.pi * 2.0
    time = period * np.arange(1000)
    signals = {"velocity": SPEED * np.sin(omega * time), "current": np.ones(time.size)}
    trace = Trace(time, signals, {"velocity": "rad/s", "current": "A"}, "a sine")
    expected = SPEED / np.sqrt(2.0) * np.sin(omega * period) / period
    assert conditions([trace], RIG, 80.0)["rms_acceleration"].value == pytest.approx(expected, rel=5e-3)


def test_one_glitch_is_no_top_speed_and_several_recordings_count_alike():
    assert conditions([recorded(4.0, 1e3)], RIG, 80.0)["top_speed"].value == pytest.approx(SPEED, rel=1e-2)
    both = conditions([recorded(2.0), recorded(4.0)], RIG, 80.0)
    assert both["duration"].value == pytest.approx(3.0)


@pytest.mark.parametrize("name", ["top_speed", "rms_speed", "rms_acceleration", "duration", "sample_period"])
def test_a_tenth_more_or_less_is_another_motion(name):
    before = {name: Measured(2.0, "s", 0.0)}
    for factor, differs in ((1.099, False), (1.0 / 1.099, False), (1.101, True), (1.0 / 1.101, True)):
        assert bool(unlike(before, {name: Measured(2.0 * factor, "s", 0.0)})) is differs
    assert unlike(before, {}) == []
    assert unlike(before, {name: Measured(3.0, "s", 0.0)}) == [f"{name.replace('_', ' ')}: 2 -> 3 s"]


def test_motions_differ_by_the_largest_of_their_ratios():
    def conditions(**values):
        return {name: Measured(value, "s", 0.0) for name, value in values.items()}

    before = conditions(top_speed=2.0, duration=4.0, rms_acceleration=0.0, rms_effort=1.0)
    assert motion_ratio(before, before) == 1.0
    assert motion_ratio(before, before | conditions(top_speed=2.2, duration=3.2, rms_effort=9.0)) == pytest.approx(1.25)
    assert motion_ratio(before, before | conditions(rms_acceleration=0.1)) == np.inf
    assert motion_ratio(before, {}) == 1.0


@pytest.mark.parametrize("name", ["rms_effort", "cutoff"])
def test_what_follows_from_the_axis_and_the_noise_is_no_other_motion(name):
    assert unlike({name: Measured(1.0, "Hz", 0.0)}, {name: Measured(9.0, "Hz", 0.0)}) == []


def test_the_error_of_a_gap_is_that_of_the_root_mean_square_of_its_independent_rows():
    """Their number is that of the rows over how many of them the filter makes alike: 400 of 1200."""
    drawn = 0.3 * np.random.default_rng(4).normal(size=(20_000, 400))
    fitted = SimpleNamespace(count=1200, rms=0.3, rows=SimpleNamespace(correlation=3.0))
    assert _torque_gap(fitted, "N*m").std_error == pytest.approx(np.sqrt((drawn**2).mean(axis=1)).std(), rel=0.02)
