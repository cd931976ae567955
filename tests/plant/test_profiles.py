"""Profiles: derivatives, limits, directions and speeds."""

import dataclasses
import math

import numpy as np
import pytest

from bench.errors import InputError
from bench.plant.axis_model import AxisParameters
from bench.plant.profile_names import DEFAULT, NAMES
from bench.plant.profiles import PROFILES, MotionLimits, plan, s_curve, through_speeds
from bench.plant.simulate import followed

FINE = MotionLimits(speed=150.0, acceleration=1200.0, full_acceleration=1500.0, travel=np.inf, period=10e-6)


@pytest.mark.parametrize("name", PROFILES)
def test_signals_are_each_others_derivatives(name):
    """Fourth-order central differences at a fine period, but for the few ticks around a bend of the acceleration."""
    r, h = plan(name, FINE), FINE.period

    def off(signal, slope):
        difference = (8.0 * (signal[3:-1] - signal[1:-3]) - (signal[4:] - signal[:-4])) / (12.0 * h)
        return np.abs(difference - slope[2:-2])

    bends = np.abs(np.diff(r.acceleration, 3)) > 1e-8 * np.abs(r.acceleration).max()
    smooth = ~np.convolve(bends, np.ones(5), mode="full")[2:-1].astype(bool)[: len(r.time) - 4]
    assert smooth.mean() > 0.5
    assert off(r.position, r.velocity)[smooth].max() < 1e-8 * FINE.speed
    assert off(r.velocity, r.acceleration)[smooth].max() < 1e-7 * FINE.full_acceleration


@pytest.mark.parametrize("name", PROFILES)
def test_starts_and_ends_at_rest_within_limits(name):
    limits = dataclasses.replace(FINE, period=250e-6)
    r = plan(name, limits)
    for signal in (r.velocity, r.acceleration):
        assert abs(signal[0]) < 1e-9
        assert abs(signal[-1]) < 1e-9
    assert r.position[0] == 0.0
    assert np.abs(r.velocity).max() <= limits.speed * (1.0 + 1e-9)
    demanded = 1.05 * limits.full_acceleration if name == "full_torque" else limits.acceleration
    assert np.abs(r.acceleration).max() <= demanded * (1.0 + 1e-9)
    np.testing.assert_allclose(np.diff(r.time), limits.period, rtol=1e-9)
    jerk = np.abs(np.diff(r.acceleration)).max() / limits.period
    assert jerk < demanded * np.pi / 2.0 / (8.0 * limits.period) * 1.01  # half a cosine in 8 ticks is the steepest


def test_identification_has_both_directions_many_speeds_and_accelerations():
    r = plan("identification", dataclasses.replace(FINE, period=250e-6))
    for direction in (-1.0, 1.0):
        steady = direction * r.velocity[(np.abs(r.acceleration) < 1e-6) & (direction * r.velocity > 1.0)]
        assert len(np.unique(np.round(steady, 3))) >= 8
        assert (direction * r.acceleration > 1000.0).sum() > 500


def test_full_torque_takes_all_the_motor_has():
    assert np.abs(plan("full_torque", FINE).acceleration).max() == pytest.approx(1.05 * FINE.full_acceleration)


@pytest.mark.parametrize("name", PROFILES)
def test_stays_within_the_travel(name):
    limits = MotionLimits(speed=1.2, acceleration=8.0, full_acceleration=10.0, travel=0.3, period=1e-3)
    r = plan(name, limits)
    assert np.ptp(r.position) <= 0.3
    assert np.abs(r.velocity).max() > 0.01


def test_s_curve_by_hand():
    """1 s up to 2 rad/s**2, 1 s at it, 1 s back to zero: 4 rad/s, and as far as a symmetric rise goes, 6 rad."""
    r = s_curve([(1.0, 2.0), (1.0, 2.0), (1.0, 0.0)], 0.25)
    assert r.velocity[-1] == pytest.approx(4.0)
    assert r.position[-1] == pytest.approx(6.0)
    assert r.acceleration[[0, 2, 4, 6, 8, 10, 12]] == pytest.approx([0.0, 1.0, 2.0, 2.0, 2.0, 1.0, 0.0])


def test_small_speed_changes_stay_below_the_acceleration():
    limits = MotionLimits(speed=100.0, acceleration=1e3, full_acceleration=1e3, travel=math.inf, period=1e-4)
    assert limits.ramp_time == pytest.approx(0.01)
    r = through_speeds(limits, [0.1, 0.0], 0.5)
    assert r.velocity.max() == pytest.approx(0.1)
    assert r.acceleration.max() == pytest.approx(10.0)


def test_joined_motions_go_on_where_the_first_ended():
    first, second = plan("fast_reversals", FINE), plan("slow_reversals", FINE)
    both = first.then(second)
    assert len(both.time) == len(first.time) + len(second.time)
    np.testing.assert_allclose(np.diff(both.time), FINE.period, rtol=1e-6)
    assert np.abs(np.diff(both.position)).max() <= FINE.speed * FINE.period * 1.001


@pytest.mark.parametrize("name", PROFILES)
def test_twice_the_limits_are_twice_the_motion_in_the_same_time(name):
    limits = dataclasses.replace(FINE, period=1e-3)
    double = {each: 2.0 * getattr(limits, each) for each in ("speed", "acceleration", "full_acceleration")}
    once, twice = plan(name, limits), plan(name, dataclasses.replace(limits, **double))
    np.testing.assert_allclose(twice.time, once.time)
    for signal in ("position", "velocity", "acceleration"):
        np.testing.assert_allclose(getattr(twice, signal), 2.0 * getattr(once, signal), rtol=1e-9, atol=1e-6)


def test_speeds_in_a_row_are_followed_through_each_of_them_from_rest_to_rest():
    speed = np.random.default_rng(0).normal(size=200).cumsum()
    r = followed(speed, 1e-3, 250e-6)
    ramp = round((r.time.size - 1 - 4 * 199) / 2)
    assert ramp > 0
    assert r.velocity[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-12)
    np.testing.assert_allclose(r.velocity[ramp:-ramp:4], speed, atol=1e-9)
    between = (r.velocity[1:] + r.velocity[:-1]) / 2.0
    np.testing.assert_allclose(np.diff(r.position), between * 250e-6, atol=5e-5)


def test_unknown_profile_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'multisine'"):
        plan("multisin", FINE)


def test_limits_follow_the_rig(rig_of):
    parameters = AxisParameters(2.2e-3, 1.1e-3, 0.085)
    slow = MotionLimits.from_rig(rig_of(motor='maximum_speed = "600 rpm"'), parameters, 250e-6)
    assert slow.speed == pytest.approx(0.8 * 20.0 * np.pi)
    volts = MotionLimits.from_rig(
        rig_of(motor='supply_voltage = "40 V"\nback_emf_constant = "0.8 V*s/rad"'), parameters, 250e-6
    )
    assert volts.speed == pytest.approx(40.0)


def test_limits_by_hand(rig_of):
    """0.7 N*m/A at 5 A are 3.5 N*m, of which 0.5 N*m stand against the motion; a mN*m*s/rad takes half at top speed."""
    strong = AxisParameters(2e-3, 1e-2, 0.1, load_torque=-0.4)
    limits = MotionLimits.from_rig(rig_of(), strong, 250e-6)
    assert limits.full_acceleration == pytest.approx(3.0 / 2e-3)
    assert limits.speed == pytest.approx((1.75 - 0.5) / 1e-2)
    assert limits.acceleration == pytest.approx(0.8 * (3.5 - 1.75) / 2e-3)
    assert limits.ramp_time == pytest.approx(0.1 * 125.0 / 700.0)
    free = MotionLimits.from_rig(rig_of(), AxisParameters(2e-3), 250e-6)
    assert free.speed == pytest.approx(0.1 * 1750.0)
    assert free.travel == np.inf


def test_limits_refuse_what_the_motor_cannot_move(rig_of):
    with pytest.raises(InputError, match="friction and load"):
        MotionLimits.from_rig(rig_of(), AxisParameters(2.2e-3, 0.0, 2.0), 250e-6)


def test_the_command_line_lists_the_profiles_there_are():
    assert tuple(PROFILES) == NAMES
    assert DEFAULT in NAMES
