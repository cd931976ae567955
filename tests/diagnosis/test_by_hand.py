"""Probabilities of sets of names and the rules of a policy on fits made by hand: each on both sides of its border."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.policy import POLICY
from bench.diagnosis.probability import DETECTED, Contender, Probabilities, probabilities, weighed
from bench.effects.backlash import Backlash
from bench.effects.directional_load_friction import DirectionalLoadFriction
from bench.effects.rivals import RIVALS
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows
from tests.diagnosis.constructed import RIG, moved, recorded
from tests.diagnosis.hand_made import level, made, term

SPRING, COGGING = term("torsion_spring"), term("cogging_torque", 6.0)
OUTSIDE = Term(RIVALS[0], tuple(shape.grid[0] for shape in RIVALS[0].shapes))


def of(sets, none, detected=()):
    return Probabilities({frozenset(names): share for names, share in sets}, none, frozenset(detected))


THREE = of([(("a", "b"), 0.6), (("a", "c"), 0.25), ((), 0.05)], 0.1)


def test_a_name_is_as_likely_as_the_sets_that_hold_it():
    assert THREE.names == pytest.approx({"a": 0.85, "b": 0.6, "c": 0.25})
    assert THREE.nothing == pytest.approx(0.05)
    assert THREE.chosen == {"a", "b"}


def test_a_set_is_chosen_only_of_names_that_are_likelier_than_not():
    split = of([(("a", "b"), 0.4), (("a", "c"), 0.35), (("a",), 0.2), ((), 0.01)], 0.04)
    assert split.chosen == {"a"}
    assert of([(("a",), 0.4), ((), 0.1)], 0.5).chosen == frozenset()


def test_what_stands_in_the_place_of_a_name():
    assert THREE.instead_of("b") == pytest.approx({"c": 0.25, None: 0.1})
    assert THREE.instead_of("a") == pytest.approx({None: 0.1})


@pytest.mark.parametrize(("level", "count"), [(0.5, 1), (0.6, 1), (0.61, 2), (0.9, 3), (0.99, 4)])
def test_the_fewest_sets_that_hold_the_truth(level, count):
    assert len(THREE.holding(level)) == count
    assert THREE.holding(0.99)[2] is None


def test_what_held_out_motion_speaks_against_leaves_the_others_as_likely():
    left = THREE.without(frozenset({"b"}))
    assert left.names == pytest.approx({"a": 0.85, "c": 0.25})
    assert (left.none, left.nothing) == pytest.approx((0.1, 0.05))


def test_where_it_speaks_against_the_only_name_that_is_none_of_the_catalogue():
    left = of([(("a",), 0.7), (("b",), 0.1), ((), 0.05)], 0.15).without(frozenset({"a"}))
    assert left.names == pytest.approx({"b": 0.1})
    assert (left.none, left.nothing) == pytest.approx((0.85, 0.05))


def test_what_signals_show_is_known_from_them():
    found = of([((), 0.96)], 0.04, ["voltage_limit"])
    assert found.names == {"voltage_limit": DETECTED}
    assert found.nothing == pytest.approx(0.96 * (1.0 - DETECTED))


def contender(left, over, *terms, numbers=0, outside=False):
    return Contender(made(level(1.0), *terms), left, over, 0.0, numbers, outside)


def test_the_logarithm_is_the_sum_of_what_speaks_for_and_against():
    bare, spring = contender(0.0, 2.0), contender(-4.0, 1.0, SPRING, numbers=1)
    found = probabilities([bare, spring], frozenset(), POLICY)
    ahead = 4.0 * POLICY.remaining + 1.0 * POLICY.over - POLICY.number
    assert math.log(found.names["torsion_spring"] / found.nothing) == pytest.approx(ahead)
    assert math.log(found.none / found.nothing) == pytest.approx(POLICY.none + 2.0 * POLICY.over)
    assert found.nothing + found.none + found.names["torsion_spring"] == pytest.approx(1.0)


def test_what_no_catalogue_holds_gets_no_name():
    every = [contender(0.0, 5.0), contender(-5.0, 0.0, OUTSIDE, numbers=2, outside=True)]
    found = probabilities(every, frozenset(), POLICY)
    assert found.names == {}
    assert found.none > 0.99


@pytest.mark.parametrize(("times", "counts"), [(1.01, 1.0), (0.99, 0.0)])
def test_a_name_counts_that_what_no_catalogue_holds_cannot_make_up_for(times, counts):
    """The spring is in both sets, and as likely as both if without it enough is left beside the other one."""
    rows = Rows.of(recorded(moved(2.0), lambda motion: 0.01 * motion.position), RIG)
    both, alone = (fit(rows, Hypothesis(terms)) for terms in ((SPRING, OUTSIDE), (OUTSIDE,)))
    assert alone.chi > 1.2 * both.chi
    policy = replace(POLICY, with_unknown=times * both.chi / alone.chi)
    weighs = POLICY.outside - POLICY.number
    every = [
        contender(0.0, 9.0),
        contender(-5.0, 0.0, COGGING, SPRING, numbers=3),
        Contender(both, -5.0, 0.0, 0.0, 2, True),
    ]
    found = probabilities(every, frozenset(), policy)
    (chosen,) = (share for names, share in found.sets.items() if names)
    beside = counts * chosen * math.exp(-weighs)
    assert found.names == pytest.approx({"torsion_spring": chosen + beside, "cogging_torque": chosen}, rel=1e-6)
    assert found.none == pytest.approx(1.0 - chosen, abs=1e-6)
    assert found.instead_of("torsion_spring") == pytest.approx({None: found.none - beside})
    assert found.instead_of("cogging_torque") == pytest.approx({None: found.none})
    left = found.without(frozenset({"torsion_spring"}))
    assert left.names == pytest.approx({"cogging_torque": chosen})


def test_sets_that_a_recording_cannot_tell_apart_count_as_one():
    offset, difference = term("torque_offset"), term("direction_dependent_friction")
    every = [contender(0.0, 3.0), *(contender(-6.0, 0.0, one, numbers=1) for one in (offset, difference))]
    found = probabilities(every, frozenset(), POLICY)
    assert len(found.names) == 1
    assert found.sets[found.chosen] > 0.99


def test_of_two_that_leave_less_than_was_taken_for_noise_the_one_that_leaves_less_is_likelier():
    """By half of `remaining` rows: (v2/v1)**remaining."""
    every = [made(level(9e3)), made(level(54.0), SPRING, floor=1.0), made(level(94.0), COGGING, floor=1.0)]
    found = probabilities(weighed(every, None, POLICY), frozenset(), POLICY)
    ratio = found.names["torsion_spring"] / found.names["cogging_torque"]
    assert ratio == pytest.approx((94.0 / 54.0) ** POLICY.remaining)


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


@pytest.mark.parametrize(
    ("sets", "chosen"),
    [
        ((("ab", 0.46), ("ac", 0.29), ("", 0.04), ("a", 0.01)), {"a"}),
        # of names that were never tried by themselves, as many as were
        ((("abd", 0.46), ("abc", 0.29), ("", 0.04), ("b", 0.0)), {"b"}),
    ],
)
def test_what_is_in_every_likely_set_is_named_without_what_differs_between_them(sets, chosen):
    """P(a) = 0.46 + 0.29 + 0.01, P(b) = 0.46, P(c) = 0.29; no likely set is of names likelier than not alone."""
    assert of(sets, 0.2).chosen == chosen


OFFSET = term("torque_offset")


@pytest.mark.parametrize(("numbers", "floor", "squares"), [(1, 1.0, 80.0), (3, 1.0, 240.0), (1, 0.5, 20.0)])
def test_forty_times_the_noise_of_an_independent_row_is_more_than_chance(numbers, floor, squares):
    """Of 100 rows two count as one: an effect of one number must save 40*1*2*1 = 80 squares."""
    assert POLICY.by_chance(made(level(100.0), floor=floor), numbers) == pytest.approx(squares)


@pytest.mark.parametrize(
    ("before", "after", "white", "damps"),
    [(841.0, 600.0, 0.8, True), (841.0, 600.0, 1.0, False), (961.0, 600.0, 0.5, False)],
    ids=["2.9 becomes 3.1", "2.9 becomes 2.4", "3.1"],
)
def test_what_leaves_more_over_its_own_noise_only_damps_unless_it_was_no_noise(before, after, white, damps):
    """Residual over white noise: at 3 and more it is no noise that is damped."""
    assert POLICY.only_damps(made(level(before)), made(level(after), SPRING, floor=white)) is damps


@pytest.mark.parametrize(
    ("squares", "effect", "room"),
    [
        (124.0, Backlash(), False),
        (127.0, Backlash(), True),
        (127.0, DirectionalLoadFriction(), False),
        (2000.0, DirectionalLoadFriction(), False),
        (2010.0, DirectionalLoadFriction(), True),
    ],
)
def test_to_parts_that_meet_all_beyond_white_noise_is_left(squares, effect, room):
    """Bursts pass for noise of four times the white one."""
    assert POLICY.leaves_room(made(level(squares), OFFSET, floor=4.0, white=1.0), effect) is room


def test_twelve_hundredths_above_the_floor_are_a_remainder():
    assert not POLICY.remains(made(level(100.0 * 1.11**2)))
    assert POLICY.remains(made(level(100.0 * 1.13**2)))


@pytest.mark.parametrize(("lasting", "physical"), [(0.099, False), (0.101, True)])
def test_an_event_outlasts_ten_periods_of_a_contact_that_it_stands_beside(lasting, physical):
    """At 200*pi rad/s a period is 10 ms; alone, an event lasts as long as the filter shows."""
    event, contact = term("load_torque_event", 1.0, 1.0 + lasting), term("backlash", 0.04, 200.0 * math.pi, 0.3, 0.0)
    assert POLICY.physical(made(level(100.0), event, contact, strengths=(1.0, 0.5))) is physical
    assert POLICY.physical(made(level(100.0), event))
