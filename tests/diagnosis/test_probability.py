"""What a search takes up is not believed: it is the nearest name, and something else is likelier.

The truth is a torque that the test adds: one that no effect is, or one whose own name the search may not try.
"""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from bench.diagnosis.policy import Policy
from bench.diagnosis.probability import Probabilities, probabilities, weighed
from bench.effects.catalogue import catalogue
from bench.effects.effect import Coupling
from tests.diagnosis.constructed import (
    SINES,
    moved,
    names,
    offset,
    only_during,
    recorded,
    sought,
    vibration,
    wave,
)
from tests.diagnosis.hand_made import made, term

POLICY = Policy()
MOTION = moved(4.0)
OTHER = moved(4.0, sines=tuple((amplitude, 1.1 * f, phase + 1.0) for amplitude, f, phase in SINES))
EVENT = ("load_torque_event",)
RIGID = [name for name, effect in catalogue().items() if not isinstance(effect, Coupling)]


def but(*names):
    """Effects on one body, less some."""
    return [name for name in RIGID if name not in names]


def test_an_event_that_the_holdout_does_not_show_is_one():
    trace = recorded(MOTION, only_during(0.08, 1.0, 1.5))
    assert names(POLICY, trace, EVENT, recorded(OTHER, seed=1)) == EVENT


def test_an_event_at_the_same_time_of_the_holdout_is_one():
    trace, holdout = (recorded(motion, only_during(0.08, 1.0, 1.5), seed=k) for k, motion in enumerate((MOTION, OTHER)))
    assert names(POLICY, trace, EVENT, holdout) == EVENT


def test_what_happens_in_the_holdout_at_any_time_is_no_event():
    trace = recorded(MOTION, only_during(0.08, 1.0, 1.5))
    holdout = recorded(OTHER, only_during(0.08, 2.5, 3.0), seed=1)
    assert names(POLICY, trace, EVENT, holdout) == ()
    assert sought(POLICY, trace, EVENT) == EVENT


@pytest.mark.parametrize(("damping", "stays"), [(0.1, True), (0.6, False)])
def test_a_coupling_that_hardly_rings_is_none(damping, stays):
    assert catalogue()["elastic_coupling"].credible((200.0, damping)) is stays


def test_a_vibration_in_step_with_the_motion_is_no_spring():
    """Position swings at 0.43 Hz, and so does the torque: over ten periods a spring explains nine tenths of it."""
    trace = recorded(moved(), vibration(0.05, 0.43))
    assert names(POLICY, trace, RIGID) == ()
    assert sought(POLICY, trace, RIGID) == ("torsion_spring",)


def test_a_name_that_explains_another_part_is_not_contested():
    """Beside a vibration cogging keeps all its worth, so the rival takes nothing from it."""
    trace = recorded(moved(), vibration(0.02, 0.9), wave(0.06, 6.0))
    assert names(POLICY, trace, RIGID) == ("cogging_torque",)


def test_a_wave_of_acceleration_is_no_ripple():
    """Three cycles a revolution it has, but goes with acceleration: an inertia's, which may not be named here."""
    trace = recorded(moved(), lambda motion: 2e-4 * motion.acceleration * np.sin(3.0 * motion.position))
    assert names(POLICY, trace, but("position_dependent_inertia")) == ()
    assert sought(POLICY, trace, but("position_dependent_inertia")) == ("torque_ripple",)


def test_one_wave_is_not_called_two():
    """A wave that goes with the square of speed is the half of what inertia and ripple make together."""
    trace = recorded(MOTION, lambda motion: 5e-5 * motion.velocity**2 * np.sin(2.0 * motion.position + 0.7))
    assert names(POLICY, trace, RIGID) == ()
    assert set(sought(POLICY, trace, RIGID)) == {
        "position_dependent_inertia",
        "torque_ripple",
    }


def test_two_waves_of_one_period_stay_where_no_single_one_replaces_them():
    trace = recorded(
        MOTION,
        lambda motion: 0.3 * motion.sign * 0.08 * np.sin(motion.position),
        wave(0.06, 1.0, 1.0),
    )
    assert set(names(POLICY, trace, RIGID)) == {"position_dependent_friction", "unbalance"}


def test_a_bump_at_one_angle_is_no_series_of_waves():
    trace = recorded(moved(), lambda motion: 0.06 * np.exp(-0.5 * (np.angle(np.exp(1j * motion.position)) / 0.5) ** 2))
    assert names(POLICY, trace, RIGID) == ()
    assert "cogging_torque" in sought(POLICY, trace, RIGID)


def test_waves_of_several_numbers_are_a_series():
    trace = recorded(moved(), wave(0.03, 1.0), wave(0.03, 6.0, 1.0), wave(0.03, 12.0, 2.0))
    assert set(names(POLICY, trace, RIGID)) == {"unbalance", "cogging_torque"}


def test_friction_that_differs_by_a_constant_is_an_offset():
    trace = recorded(MOTION, offset(0.05))
    assert names(POLICY, trace, RIGID) == ("torque_offset",)
    assert sought(POLICY, trace, RIGID) == ("torque_offset",)  # of one number, where the other has two


def test_friction_that_differs_by_more_is_no_offset():
    trace = recorded(MOTION, lambda motion: 0.05 + 5e-4 * np.abs(motion.velocity))
    assert names(POLICY, trace, RIGID) == ("direction_dependent_friction",)


def wandering(seed, torque):
    """A torque of that RMS - N*m - that changes at random within a tenth of a second or so."""
    wander = gaussian_filter1d(np.random.default_rng(seed).normal(size=MOTION.time.size), 120)
    return lambda motion: torque * (wander - wander.mean()) / wander.std()


@pytest.mark.parametrize("seed", [7, pytest.param(20, marks=pytest.mark.slow)])
def test_a_torque_that_wanders_is_no_event(seed):
    """Half of what wanders may pass for an event; what stays beside it says that it is none."""
    trace = recorded(MOTION, wandering(seed, 0.1))
    assert names(POLICY, trace, RIGID) == ()


def test_of_names_beside_a_large_remainder_an_event_goes_first():
    """Most of the torque is cogging; what wanders beside it speaks against an event, and not against cogging."""
    trace = recorded(MOTION, wandering(7, 0.06), wave(0.3, 6.0))
    kept = names(POLICY, trace, RIGID)
    assert "cogging_torque" in kept
    assert "load_torque_event" not in kept


@pytest.mark.parametrize(("determined", "nothing"), [(0.3, 0.01), (0.6, 0.01), (1.0, 0.86)])
def test_what_rings_beside_impacts_is_not_nothing(determined, nothing):
    """Rows that a gap determines leave noise with it and without, the others ten times as much, which it may excuse.

    Nothing weighs 1 where all is noise, else e**(-over*MUCH); none of the catalogue e**none, the gap e**(-4*number).
    """
    sure = np.arange(100) < 100 * determined
    left = np.where(sure, 1.0, 10.0)
    gap = made(left, term("backlash", 0.01, 500.0, 0.4, 0.0), determined=list(sure), strengths=(0.5,))
    found = probabilities(weighed([made(left), gap], None, POLICY), frozenset(), POLICY)
    assert found.nothing == pytest.approx(nothing, abs=0.05)
    assert found.names.get("backlash", 0.0) < 0.05


def sets(*pairs):
    return Probabilities({frozenset(names): share for names, share in pairs}, 0.2)


def test_what_stands_in_every_likely_set_is_named_without_what_differs_between_them():
    """P(a) = 0.46 + 0.29 + 0.01, P(b) = 0.46, P(c) = 0.29; no likely set is of names likelier than not alone."""
    assert sets(("ab", 0.46), ("ac", 0.29), ("", 0.04), ("a", 0.01)).chosen == {"a"}


def test_of_names_that_were_never_tried_by_themselves_as_many_are_named_as_were():
    assert sets(("abd", 0.46), ("abc", 0.29), ("", 0.04), ("b", 0.0)).chosen == {"b"}
