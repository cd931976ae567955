"""Each rule on both sides of its threshold, on fits whose squares and floors are made by hand.

100 rows two of which count as one, a noise of 1: an effect of one number must save 40 * 1 * 2 * 1 = 80 squares.
"""

import math

import pytest

from bench.diagnosis import search
from bench.diagnosis.policy import Policy
from bench.diagnosis.search import Candidate
from bench.effects.backlash import Backlash
from bench.effects.directional_load_friction import DirectionalLoadFriction
from tests.diagnosis.hand_made import level, made, term

POLICY = Policy()
SPRING, OFFSET, EVENT = term("torsion_spring"), term("torque_offset"), term("load_torque_event", 1.0, 1.5)
OTHER = term("unbalance")


def threshold(fitted, numbers=1):
    return POLICY.by_chance(fitted, numbers)


def explains(before, after):
    return POLICY.accepts(before, after)


def promising(current, tried):
    return [each for each in tried if POLICY.promises(current, each.gain)]


def no_longer_needed(fitted, less, index=0):
    return not POLICY.needs(fitted, less, index)


def replaces(before, after):
    return POLICY.replaces_by(before, after, before)


def remains(fitted):
    return POLICY.remains(fitted)


def tried(*gains):
    return [Candidate(OTHER, gain) for gain in gains]


@pytest.mark.parametrize(("numbers", "floor", "squares"), [(1, 1.0, 80.0), (3, 1.0, 240.0), (1, 0.5, 20.0)])
def test_forty_times_the_noise_of_an_independent_row_is_more_than_chance(numbers, floor, squares):
    assert threshold(made(level(100.0), floor=floor), numbers) == pytest.approx(squares)


@pytest.mark.parametrize(("saved", "named"), [(324.0, False), (326.0, True)])
def test_an_effect_explains_a_quarter_of_what_stands_above_the_floor(saved, named):
    """1400 squares, 1300 of them above the floor of 100 rows."""
    assert explains(made(level(1400.0)), made(level(1400.0 - saved), SPRING)) is named


@pytest.mark.parametrize(("saved", "named"), [(649.0, False), (651.0, True)])
def test_an_event_explains_a_half_of_it(saved, named):
    assert explains(made(level(1400.0)), made(level(1400.0 - saved), EVENT, strengths=(1.0,))) is named


@pytest.mark.parametrize(("saved", "named"), [(79.0, False), (81.0, True)])
def test_an_effect_saves_more_than_chance(saved, named):
    """280 squares, 180 above the floor, a quarter of which are 45: chance decides."""
    assert explains(made(level(280.0)), made(level(280.0 - saved), SPRING)) is named


@pytest.mark.parametrize(
    ("before", "after", "named"),
    [
        ((1.0, 1.0), (2.0, 1.0), True),
        ((2.0, 1.0), (1.0, 1.0), True),
        ((2.0, 1.0), (2.0, 2.0), True),
        ((2.0, 1.0), (2.0, 1.0), False),
    ],
    ids=["before", "after", "after, over its white noise", "neither"],
)
def test_the_less_coloured_of_both_floors_says_what_noise_is(before, after, named):
    """120 squares saved of 380: more than chance, 80, and a quarter of 280, unless the floor is twice as high."""
    without = made(level(380.0), floor=before[0], white=before[1])
    assert explains(without, made(level(260.0), SPRING, floor=after[0], white=after[1])) is named


@pytest.mark.parametrize(("saved", "named"), [(399.0, False), (401.0, True)])
def test_noise_that_an_effect_damps_is_not_explained(saved, named):
    """Of 100 rows whose noise falls from 1 to 1/4 in power 75 squares are damped, 325 are asked."""
    assert explains(made(level(1400.0)), made(level(1400.0 - saved), SPRING, floor=0.5)) is named


@pytest.mark.parametrize(
    ("before", "after", "white", "damps"),
    [(841.0, 600.0, 0.8, True), (841.0, 600.0, 1.0, False), (961.0, 600.0, 0.5, False)],
    ids=["2.9 becomes 3.1", "2.9 becomes 2.4", "3.1"],
)
def test_what_leaves_more_over_its_own_noise_only_damps_unless_it_was_no_noise(before, after, white, damps):
    """Residual over white noise: at 3 and more it is no noise that is damped."""
    assert POLICY.only_damps(made(level(before)), made(level(after), SPRING, floor=white)) is damps


def test_a_tenth_of_what_stands_above_the_floor_promises_something():
    assert [c.gain for c in promising(made(level(1400.0)), tried(131.0, 129.0))] == [131.0]
    assert [c.gain for c in promising(made(level(200.0)), tried(81.0, 79.0))] == [81.0]


@pytest.mark.parametrize(("gains", "asked"), [((91.0, 89.0), 1), ((99.0,) * 9, 2)])
def test_what_takes_nine_tenths_may_stand_in_another_s_place(monkeypatch, gains, asked):
    """A spring takes 100 squares beside an offset; of what takes 90 in its place two shapes at most are searched."""
    searched = []
    monkeypatch.setattr(search, "fit", lambda rows, hypothesis: made(level(1100.0), OFFSET))
    monkeypatch.setattr(search, "candidates", lambda less, effects: tried(*gains))
    monkeypatch.setattr(search, "refined", lambda less, wave: searched.append(wave) or made(level(1000.0), OFFSET))
    fitted = made(level(1000.0), SPRING, OFFSET)
    assert search.exchanged(fitted, search.instead_of_each(fitted, [], POLICY), POLICY) is None
    assert len(searched) == asked


@pytest.mark.parametrize(("saved", "exchanged"), [(79.0, False), (81.0, True)])
def test_what_is_exchanged_leaves_less_by_more_than_chance(saved, exchanged):
    before, after = made(level(1000.0), SPRING, OFFSET), made(level(1000.0 - saved), OFFSET, term("quadratic_drag"))
    assert POLICY.exchanges_for(before, after) is exchanged


@pytest.mark.parametrize(
    ("squares", "lost", "goes"),
    [(1400.0, 79.0, True), (1400.0, 81.0, False), (10100.0, 199.0, True), (10100.0, 201.0, False)],
)
def test_a_name_goes_that_saves_no_more_than_chance_or_a_fiftieth(squares, lost, goes):
    """Chance saves 80; a fiftieth of 10000 above the floor is 200."""
    assert no_longer_needed(made(level(squares - lost), SPRING), made(level(squares))) is goes


def test_a_name_that_only_damps_noise_goes():
    assert no_longer_needed(made(level(500.0), SPRING, floor=0.7), made(level(800.0)))
    assert not no_longer_needed(made(level(500.0), SPRING), made(level(800.0)))


@pytest.mark.parametrize(
    ("saved", "strength", "inertia", "taken"),
    [(499.0, 1.0, 1.0, False), (501.0, 1.0, 1.0, True), (501.0, -1.0, 1.0, False), (501.0, 1.0, -1e-9, False)],
)
def test_what_replaces_takes_half_of_what_stands_above_the_floor_physically(saved, strength, inertia, taken):
    """Its own strength, and the inertia that it leaves: what copies torque may take both."""
    after = made(level(1100.0 - saved), SPRING, strengths=(strength,), inertia=inertia)
    assert replaces(made(level(1100.0), OFFSET), after) is taken


@pytest.mark.parametrize(("saved", "inertia", "leads"), [(99.0, 1.0, False), (101.0, 1.0, True), (101.0, -1e-9, False)])
def test_a_search_goes_on_from_what_takes_a_tenth_in_the_place_of_others(saved, inertia, leads):
    after = made(level(1100.0 - saved), SPRING, inertia=inertia)
    assert POLICY.leads(made(level(1100.0), OFFSET), after) is leads


@pytest.mark.parametrize(
    ("sure", "beyond", "taken"), [(60, 21.9, True), (60, 22.1, False), (51, 8.0, True), (50, 8.0, False)]
)
def test_what_replaces_is_sure_of_most_rows_and_leaves_at_most_twice_on_the_others(sure, beyond, taken):
    """11 squares a row before; after, 5.9 on each row that it is sure of and `beyond` on the others."""
    left = [math.sqrt(5.9)] * sure + [math.sqrt(beyond)] * (100 - sure)
    after = made(left, SPRING, determined=[k < sure for k in range(100)])
    assert replaces(made(level(1100.0), OFFSET), after) is taken


@pytest.mark.parametrize(
    ("squares", "floor", "saved", "taken"),
    [(1100.0, 4.0, 499.0, False), (1100.0, 4.0, 501.0, True), (120.0, 1.0, 79.0, False), (120.0, 1.0, 81.0, True)],
    ids=["floor", "floor", "chance", "chance"],
)
def test_what_replaces_takes_half_above_the_less_coloured_floor_and_more_than_chance(squares, floor, saved, taken):
    """Beside a coupling the bursts of a backlash pass for noise of four times the white one."""
    after = made(level(squares - saved), SPRING)
    assert replaces(made(level(squares), OFFSET, floor=floor, white=1.0), after) is taken


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
