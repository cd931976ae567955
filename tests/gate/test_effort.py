"""Effort that does not follow the motion."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.gate import effort
from bench.gate.gate import passed
from tests.gate.damage import changed


def test_a_turned_current_is_refused_and_named(sound, rig):
    with pytest.raises(InputError, match=r"effort_follows_motion.*opposite signs.*\[trace.columns\]"):
        passed(changed(sound, current=-sound["current"]), rig)


def test_another_axis_current_is_refused(sound, rig):
    foreign = np.sin(2.0 * np.pi * 1.7 * sound.time)
    found = effort.check(changed(sound, current=foreign), rig)[1]
    assert found.status == "fail"
    assert "another axis" in found.advice


def test_noise_alone_is_told_as_no_torque_signal(sound, rig):
    noise = np.random.default_rng(2).normal(size=len(sound))
    found = effort.check(changed(sound, current=noise), rig)[1]
    assert found.status == "warn"
    assert "no torque signal" in found.advice


def test_gravity_is_named_as_likeliest(sound, rig):
    heavy = changed(sound, current=sound["current"] + 8.0 * np.sin(sound["position"]))
    found = effort.check(heavy, rig)[1]
    assert found.status == "pass"
    assert "gravity" in found.advice
