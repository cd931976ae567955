"""The simulated servo against closed forms, and what in it cannot be told apart."""

import numpy as np
import pytest

from bench.servos.model import Stretches, simulated

PERIOD, LENGTH = 0.01, 120


def stretches(goal, position=0.0, steps=4):
    zero = np.zeros(goal.size)
    return Stretches(PERIOD, np.array([0]), goal.size, goal, zero, zero, np.array([position]), np.array([0.0]), steps)


def run(goal, position=0.0, steps=4, **values):
    given = {name: np.array([value]) for name, value in values.items()}
    return simulated(given, stretches(goal, position, steps))[0][0, 0]


def step_response(time, natural, damped):
    """Of a loop of second order (n,), to a step of the goal at zero."""
    time, root = np.maximum(time, 0.0), np.sqrt(1.0 - damped**2)
    wave = np.cos(natural * root * time) + damped / root * np.sin(natural * root * time)
    return 1.0 - np.exp(-damped * natural * time) * wave


def test_a_step_response_is_that_of_second_order():
    found = run(np.ones(LENGTH), stiffness=25.0**2, damping=2.0 * 0.4 * 25.0)
    assert found == pytest.approx(step_response(PERIOD * np.arange(LENGTH), 25.0, 0.4), abs=1e-9)


def test_a_dead_time_of_part_of_a_step_delays_by_it():
    goal = np.where(np.arange(LENGTH) < 20, 0.0, 1.0)
    values = {"stiffness": 400.0, "damping": 30.0}
    late = run(goal, dead_time=0.0371, steps=10, **values)
    closed = step_response(PERIOD * np.arange(LENGTH) - 0.2371, 20.0, 0.75)
    assert late == pytest.approx(closed, abs=1e-4)
    whole = run(goal, dead_time=0.04, **values)
    assert whole[4:] == pytest.approx(run(goal, **values)[:-4], abs=1e-12)


def test_friction_holds_within_its_static_error_and_stops_at_the_closed_form():
    """From rest under a constant net rate; then, without a controller, it coasts to rest after w**2/(2*f)."""
    held = run(np.full(LENGTH, 0.01), stiffness=100.0, damping=5.0, friction=1.01)
    assert np.all(held == 0.0)
    given = {"stiffness": np.array([0.0]), "friction": np.array([3.0])}
    of = stretches(np.zeros(LENGTH))
    coasting = Stretches(PERIOD, of.starts, LENGTH, of.goal, of.known, of.known_slope, of.position, np.array([2.0]), 4)
    assert simulated(given, coasting)[0][0, 0, -1] == pytest.approx(2.0**2 / (2.0 * 3.0), rel=1e-9)


def test_a_limit_bounds_the_rate():
    """At the limit l the servo moves by l*t**2/2, whatever its gains."""
    goal = np.full(LENGTH, 100.0)
    found = run(goal, stiffness=400.0, drive_damping=1.0, limit=2.0)
    assert found[:50] == pytest.approx(0.5 * 2.0 * (PERIOD * np.arange(50)) ** 2, rel=1e-9)


def test_both_dampings_act_alike_until_the_limit_is_reached():
    goal = np.sin(0.3 * np.arange(LENGTH))
    both = [run(goal, stiffness=300.0, damping=b, drive_damping=20.0 - b) for b in (0.0, 8.0, 20.0)]
    assert both[0] == pytest.approx(both[1], abs=1e-12)
    assert both[0] == pytest.approx(both[2], abs=1e-12)
    limited = [run(goal, stiffness=300.0, damping=b, drive_damping=20.0 - b, limit=60.0) for b in (0.0, 20.0)]
    assert np.abs(limited[0] - limited[1]).max() > 0.01


def test_halving_the_step_converges_with_stick_slip_and_a_limit():
    goal = np.where((np.arange(LENGTH) // 30) % 2 == 0, 0.0, 1.0) + 0.1 * np.sin(0.5 * np.arange(LENGTH))
    values = {"stiffness": 500.0, "damping": 10.0, "drive_damping": 10.0, "friction": 20.0, "limit": 150.0}
    runs = [run(goal, steps=steps, **values) for steps in (4, 8, 128)]
    errors = [np.abs(one - runs[-1]).max() for one in runs[:2]]
    assert errors[0] < 4e-3
    assert errors[1] < 0.6 * errors[0]


def test_a_play_hides_motion_within_it():
    goal = 0.5 * np.sin(0.1 * np.arange(LENGTH))
    free = run(goal, stiffness=400.0, damping=40.0)
    behind = run(goal, stiffness=400.0, damping=40.0, play=0.1)
    assert np.abs(behind - free).max() > 0.02
