"""Recordings of the independent axis whose current is damaged as recorders and sensors do it: no false name of it."""

from functools import cache

import numpy as np
import pytest
from scipy.signal import lfilter

from bench.diagnosis.diagnosis import diagnose
from bench.rig.rig import Rig
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from tests.recorded import PLAIN

AXIS = PLAIN.axis
RIG = Rig.of(
    {
        "name": "axis",
        "kind": "rotary",
        "motor": {"torque_constant": "0.7 N*m/A", "rotor_inertia": "5 kg*cm**2", "peak_current": "6 A"},
        "drive": {
            "position_gain": f"{AXIS.position_gain} 1/s",
            "velocity_gain": "0.15 N*m*s/rad",
            "integral_gain": "2 N*m/rad",
            "inertia_feedforward": "14 kg*cm**2",
            "control_period": f"{AXIS.control_period} s",
        },
    }
)
#: A recursive filter of one sample is found in twice as many.
SECONDS = 3.0
SINGLES = {
    "quadratic_drag": (2.5e-5,),
    "cogging_torque": (0.06, 6.0, 0.4),
    "unbalance": (0.15, 0.3),
    "stribeck_friction": (0.2, 3.0),
}
#: Amperes that a current is cut off or rounded to.
DIGIT = 0.02
#: Of a recursive filter of one sample's time constant: the mean of its impulse response, 1/(e - 1) samples - s.
DELAY = 1e-3 / (np.e - 1.0)


def filtered(current, time, lag=1e-3):
    pole = np.exp(-(time[1] - time[0]) / lag)
    return lfilter([1.0 - pole], [1.0, -pole], current, zi=[pole * current[0]])[0]


def late(current, time):
    return np.interp(time - 0.5e-3, time, current)


def stale(current, time):
    """Some samples repeat the one before."""
    fresh = np.random.default_rng(5).random(current.size) >= 0.02
    return current[np.maximum.accumulate(np.where(fresh, np.arange(current.size), 0))]


def uneven(current, time):
    """Readings of positive current are larger by a share than those of negative."""
    return current * (1.0 + 0.5 * 0.01 * np.sign(current))


def cut_off(current, time):
    return DIGIT * np.trunc(current / DIGIT)


def rounded(current, time):
    return DIGIT * np.round(current / DIGIT)


def drifting(current, time):
    return current * (1.0 + 0.02 * time / time[-1])


def right_in_the_middle(current, time):
    return drifting(current, time) / 1.01


#: Damages, and the effect of the catalogue that each may be named as.
DAMAGES = {
    late: "current_filter_lag",
    stale: None,
    uneven: "current_gain_asymmetry",
    cut_off: None,
    rounded: None,
    drifting: "torque_constant_drift",
}
#: A single takes longer than it shows, so that one of them is tried by default, with two of the damages.
SHOWN = [*((damage, None) for damage in DAMAGES), (cut_off, "stribeck_friction"), (drifting, "stribeck_friction")]
CASES = [
    pytest.param(damage, single, marks=[] if (damage, single) in SHOWN else [pytest.mark.slow])
    for damage in DAMAGES
    for single in (None, *SINGLES)
]


@cache
def recordings(seconds=SECONDS):
    """One without an effect, and one of each single."""
    cases = {None: (), **{name: (KINDS[name](*values),) for name, values in SINGLES.items()}}
    return PLAIN.record(cases, random_motion(AXIS, np.random.default_rng(11), seconds), 11)


@cache
def diagnosed(single, damage, seconds=SECONDS):
    trace = recordings(seconds)[single]
    return diagnose(trace.with_signals({"current": damage(trace["current"], trace.time)}, {}), RIG)


def right(diagnosis, single, damage):
    """Asserts the single and no false name, and J within three half widths of its interval or a percent."""
    assert set(diagnosis.names) - {damage} == {single} - {None}
    found = diagnosis.parameters["moment_of_inertia"]
    reach = max(1.5 * (found.ci95[1] - found.ci95[0]), 0.01 * AXIS.inertia)
    assert found.value == pytest.approx(AXIS.inertia, abs=reach)


@pytest.mark.parametrize(("damage", "single"), CASES)
def test_a_damaged_current_gives_no_false_name(damage, single):
    found = diagnosed(single, damage)
    right(found, single, DAMAGES[damage])
    for effect in found.effects:
        if effect.name == "current_gain_asymmetry":
            low, high = effect.parameters["gain_difference"].ci95
            assert low < -0.01 < high
            assert effect.effect.of_measurement


@pytest.mark.slow  # the lag by itself is among `test_diagnosed.py`
@pytest.mark.parametrize("single", [None, *SINGLES])
def test_a_filter_of_a_millisecond_keeps_the_names_of_singles(single):
    found = diagnosed(single, filtered, 2.0 * SECONDS)
    assert "current_filter_lag" in found.names
    right(found, single, "current_filter_lag")
    (lag,) = [effect.parameters["time_constant"] for effect in found.effects if effect.name == "current_filter_lag"]
    assert lag.value == pytest.approx(DELAY, abs=AXIS.control_period)


@pytest.mark.parametrize("damage", [drifting, right_in_the_middle])
def test_inertia_is_known_by_the_constant_of_any_moment(damage):
    """Right at the start or in the middle: the rig does not say when its torque constant is valid."""
    found = diagnosed(None, damage)
    assert found.names == ["torque_constant_drift"]
    low, high = found.parameters["moment_of_inertia"].ci95
    assert low < AXIS.inertia < high
