"""Each rule on both sides of its threshold, on fits whose squares and floors are made by hand.

100 rows two of which count as one, a noise of 1: an effect of one number must save 40 * 1 * 2 * 1 = 80 squares.
"""

import math

import pytest

from bench.diagnosis.policy import Policy
from bench.effects.backlash import Backlash
from bench.effects.directional_load_friction import DirectionalLoadFriction
from tests.diagnosis.hand_made import level, made, term

POLICY = Policy()
SPRING, OFFSET, EVENT = term("torsion_spring"), term("torque_offset"), term("load_torque_event", 1.0, 1.5)
OTHER = term("unbalance")


def threshold(fitted, numbers=1):
    return POLICY.by_chance(fitted, numbers)


def remains(fitted):
    return POLICY.remains(fitted)


@pytest.mark.parametrize(("numbers", "floor", "squares"), [(1, 1.0, 80.0), (3, 1.0, 240.0), (1, 0.5, 20.0)])
def test_forty_times_the_noise_of_an_independent_row_is_more_than_chance(numbers, floor, squares):
    assert threshold(made(level(100.0), floor=floor), numbers) == pytest.approx(squares)


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
    assert not remains(made(level(100.0 * 1.11**2)))
    assert remains(made(level(100.0 * 1.13**2)))


@pytest.mark.parametrize(("lasting", "physical"), [(0.099, False), (0.101, True)])
def test_an_event_outlasts_ten_periods_of_a_contact_that_it_stands_beside(lasting, physical):
    """At 200*pi rad/s a period is 10 ms; alone, an event lasts as long as the filter shows."""
    event, contact = term("load_torque_event", 1.0, 1.0 + lasting), term("backlash", 0.04, 200.0 * math.pi, 0.3, 0.0)
    assert POLICY.physical(made(level(100.0), event, contact, strengths=(1.0, 0.5))) is physical
    assert POLICY.physical(made(level(100.0), event))
