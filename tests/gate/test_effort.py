"""Effort that does not follow the motion."""

from dataclasses import replace

import numpy as np
import pytest

from bench.errors import InputError
from bench.gate import effort
from bench.gate.check import Seen, Sums, balanced
from bench.gate.gate import passed
from bench.trace.trace import Trace
from tests.fit.motions import UNITS
from tests.gate.damage import changed


def test_a_turned_current_is_refused_and_named(sound, rig):
    with pytest.raises(InputError, match=r"effort_follows_motion.*opposite signs.*\[trace.columns\]"):
        passed(changed(sound, current=-sound["current"]), rig)


def test_another_axis_current_is_refused(sound, rig):
    foreign = np.sin(2.0 * np.pi * 1.7 * sound.time)
    found = effort.follows_motion(Seen(changed(sound, current=foreign), rig))
    assert found.status == "fail"
    assert "another axis" in found.advice


@pytest.mark.parametrize(("least", "status"), [(0.5, "pass"), (0.0, "fail")])
def test_an_effort_of_one_sign_has_lost_it_only_if_it_is_zero_in_motion(sound, rig, least, status):
    """What presses on an axis is of one sign, too, and never zero."""
    rectified = least + np.abs(np.sin(2.0 * np.pi * 1.7 * sound.time))
    rectified[rectified < least + 0.2] = least
    assert effort.has_sign(Seen(changed(sound, current=rectified), rig)).status == status


def test_that_an_axis_stands_is_reported_first(sound, rig):
    rng = np.random.default_rng(3)
    still = {"velocity": 1e-3 * rng.normal(size=len(sound)), "position": 1e-6 * rng.normal(size=len(sound))}
    foreign = np.sin(2.0 * np.pi * 1.7 * sound.time)
    found = effort.follows_motion(Seen(changed(sound, current=foreign, **still), rig))
    assert found.status == "fail"
    assert found.found.startswith("the speed hardly changes")
    assert found.advice.endswith("move it")


def test_noise_alone_is_reported_as_no_torque_signal(sound, rig):
    noise = np.random.default_rng(2).normal(size=len(sound))
    found = effort.follows_motion(Seen(changed(sound, current=noise), rig))
    assert found.status == "warn"
    assert "no torque signal" in found.advice


def test_gravity_is_named_as_likeliest(sound, rig):
    heavy = changed(sound, current=sound["current"] + 8.0 * np.sin(sound["position"]))
    found = effort.follows_motion(Seen(heavy, rig))
    assert found.status == "pass"
    assert "gravity" in found.advice


@pytest.fixture(scope="module")
def fitted(sound):
    return Seen(sound).balance()


@pytest.mark.parametrize(
    ("by_motion", "by_position", "over_noise", "status", "advice"),
    [
        (0.46, 0.46, 1.0, "pass", ""),
        (0.44, 0.44, 9.0, "warn", "bench diagnose"),
        (0.31, 0.31, 9.0, "warn", "bench diagnose"),
        (0.29, 0.29, 9.0, "fail", "another axis"),
        (0.29, 0.29, 3.1, "fail", "another axis"),
        (0.29, 0.29, 2.9, "warn", "accelerations too small"),
        (0.44, 0.44, 2.9, "warn", "accelerations too small"),
        (0.60, 0.91, 9.0, "pass", "gravity"),
        (0.60, 0.89, 9.0, "pass", ""),
        (0.10, 0.41, 9.0, "warn", "gravity"),
    ],
)
def test_shares_explained_are_judged_by_their_borders(fitted, by_motion, by_position, over_noise, status, advice):
    stated = replace(fitted, by_motion=by_motion, by_position=by_position)
    stated.__dict__["effort_over_noise"] = over_noise
    found = effort.judged(stated, "current")
    assert found.status == status
    assert (advice in found.advice) if advice else not found.advice


@pytest.mark.parametrize("kept", [None, "inertia", "friction", "power"])
def test_signs_are_opposite_where_inertia_friction_and_power_are_negative_and_not_where_one_is_not(fitted, kept):
    inertia, coulomb, power = (1.0 if kept == name else -1.0 for name in ("inertia", "friction", "power"))
    turned = replace(fitted, inertia=inertia, coulomb=coulomb, effort=power * fitted.columns[:, 1])
    found = effort.judged(turned, "current")
    assert (found.status == "fail" and "opposite signs" in found.found) == (kept is None)


@pytest.mark.parametrize("length", [20, 80])
def test_means_over_windows_of_white_noise_stand_as_high_as_it_lets_them(length):
    """Means over so many samples of white noise have its standard deviation over the root of their number."""
    rng = np.random.default_rng(3)
    torque, speed = rng.normal(scale=0.2, size=40_000), 1.0 + rng.normal(scale=0.01, size=40_000)
    trace = Trace(1e-3 * np.arange(40_000), {"velocity": speed}, {"velocity": UNITS["velocity"]}, "noise")
    found = balanced([Sums.of(trace, speed, torque, slice(0, 40_000))], length)
    assert found is not None
    assert found.effort_over_noise == pytest.approx(1.0, rel=0.1)
    assert found.speed_over_noise == pytest.approx(1.0, rel=0.1)
