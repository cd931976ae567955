"""A fault that lasts for a while, or a delay: refused with what it likeliest is, and when."""

import re

import numpy as np
import pytest

from bench.errors import BenchError
from bench.gate import signals, throughout
from bench.gate.check import Seen
from bench.gate.gate import passed
from tests.gate.damage import changed


def during(trace, begin, end):
    return (trace.time >= begin) & (trace.time < end)


def turned(trace):
    return np.where(during(trace, 2.0, 3.5), -1.0, 1.0) * trace["current"]


def dropped(trace):
    noise = 0.003 * np.random.default_rng(0).normal(size=len(trace))
    return np.where(during(trace, 2.0, 3.5), noise, trace["current"])


def in_other_units(trace):
    return np.where(during(trace, 2.0, 3.5), 0.1, 1.0) * trace["current"]


def scaled(trace):
    """By less than what passes for a signal that dropped out."""
    return np.where(during(trace, 2.0, 3.5), 0.2, 1.0) * trace["current"]


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (turned, "the sign of current is turned"),
        (dropped, "current is nearly zero while the motion takes effort"),
        (in_other_units, "current is nearly zero while the motion takes effort"),
        (scaled, "current has another scale"),
    ],
)
def test_what_is_wrong_for_a_while_is_named_with_its_time(sound, rig, damage, words):
    bad = changed(sound, current=damage(sound))
    with pytest.raises(BenchError, match=words):
        passed(bad, rig)
    found = throughout.holds(Seen(bad, rig)).found
    begin, end = map(float, re.findall(r"([\d.]+) s", found))
    assert begin == pytest.approx(2.0, abs=0.35) and end == pytest.approx(3.5, abs=0.35)


@pytest.mark.parametrize("delay", [20, -20, 60])
def test_a_delay_is_named_with_its_size(sound, rig, delay):
    found = throughout.holds(Seen(changed(sound, current=np.roll(sound["current"], delay)), rig))
    (milliseconds,) = re.findall(rf"([\d.]+) ms {'late' if delay > 0 else 'early'}", found.found)
    assert found.status == "fail" and float(milliseconds) == pytest.approx(abs(delay), abs=3.0)


@pytest.mark.parametrize("delay", [1, 5, -5])
def test_delays_that_drives_have_are_no_fault(sound, rig, delay):
    assert throughout.holds(Seen(changed(sound, current=np.roll(sound["current"], delay)), rig)).status == "pass"


def test_zeros_that_the_motion_contradicts_are_a_drop_out_and_a_motor_that_coasts_is_none(sound, rig):
    gaps = np.isin(np.arange(len(sound)) // 60, np.arange(2, 80, 8))
    found = signals.clips(Seen(changed(sound, current=np.where(gaps, 0.0, sound["current"])), rig))
    assert found.status == "fail" and "exactly 0 A" in found.found and "dropped out" in found.advice
    quiet = abs(sound["current"]) < 0.05 * abs(sound["current"]).max()
    assert signals.clips(Seen(changed(sound, current=np.where(quiet, 0.0, sound["current"])), rig)).status == "pass"


@pytest.mark.parametrize("damage", [None, turned, dropped, scaled])
@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_the_answer_does_not_depend_on_the_unit_of_the_effort(sound, rig, damage, factor):
    current = sound["current"] if damage is None else damage(sound)
    once, other = (throughout.holds(Seen(changed(sound, current=by * current), rig)) for by in (1.0, factor))
    assert other == once
