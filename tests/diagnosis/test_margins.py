"""Each rule on both sides of its threshold, on fits whose squares and floors are made by hand.

100 rows two of which count as one, a noise of 1: an effect of one number must save 40 * 1 * 2 * 1 = 80 squares.
"""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from bench.diagnosis import doubts, search
from bench.diagnosis.doubts import Evidence, contested, not_in_holdout, simpler, unbelievable, wrong_form
from bench.diagnosis.policy import Policy
from bench.diagnosis.search import Candidate
from bench.effects.rivals import RIVALS
from bench.fit.hypothesis import Hypothesis, Term
from tests.diagnosis.hand_made import level, made, term

POLICY = Policy()
SPRING, OFFSET, EVENT = term("torsion_spring"), term("torque_offset"), term("load_torque_event", 1.0, 1.5)


def threshold(fitted, numbers=1):
    return POLICY.by_chance(fitted, numbers)


def explains(before, after):
    return POLICY.accepts(before, after)


def promising(current, tried):
    return [each for each in tried if POLICY.promises(current, each.gain)]


def no_longer_needed(fitted, less, index=0):
    return not POLICY.needs(fitted, less, index)


def replaces(before, after):
    return POLICY.replaces_by(before, after)


def remains(fitted):
    return POLICY.remains(fitted)


def evidence(without, holdout=None):
    return Evidence(without, holdout, frozenset(), POLICY)


def tried(*gains):
    return [Candidate(SPRING, gain) for gain in gains]


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
    assert search.exchanged(made(level(1000.0), SPRING, OFFSET), [], POLICY) is None
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


@pytest.mark.parametrize(
    ("sure", "beyond", "taken"), [(60, 18.0, True), (60, 19.0, False), (51, 8.0, True), (50, 8.0, False)]
)
def test_what_replaces_is_sure_of_most_rows_and_leaves_no_more_on_all(sure, beyond, taken):
    """1100 squares before, 11 a row; after, 5.9 on each row that it is sure of and `beyond` on the others."""
    left = [math.sqrt(5.9)] * sure + [math.sqrt(beyond)] * (100 - sure)
    after = made(left, SPRING, determined=[k < sure for k in range(100)])
    assert replaces(made(level(1100.0), OFFSET), after) is taken


def test_twelve_hundredths_above_the_floor_are_a_remainder():
    assert not remains(made(level(100.0 * 1.11**2)))
    assert remains(made(level(100.0 * 1.13**2)))


@pytest.mark.parametrize(
    ("before", "after", "believed"),
    [(10000.0, 1999.0, True), (10000.0, 2001.0, False), (1000.0, 780.0, True), (1000.0, 820.0, False)],
)
def test_names_that_leave_a_fifth_are_believed_below_three_floors(before, after, believed):
    """Squares above the floor; 800 of them on 100 rows are three floors."""
    without, fitted = made(level(100.0 + before)), made(level(100.0 + after), SPRING)
    assert unbelievable(fitted, evidence(without)) is (fitted if believed else without)


class Table:
    """Fits by the names of their hypotheses: squares of 100 rows each."""

    def __init__(self, monkeypatch, squares, rivals=()):
        self.squares, self.rivals = squares, rivals
        for name in ("fit", "refined", "candidates"):
            monkeypatch.setattr(doubts, name, getattr(self, name))

    def fit(self, rows, hypothesis):
        return made(level(self.squares[hypothesis.names]), *hypothesis.terms)

    def refined(self, current, term):
        return self.fit(None, current.hypothesis.plus(term))

    def candidates(self, current, effects):
        return [Candidate(term, 1.0) for term in self.rivals]


RIVAL = Term(next(effect for effect in RIVALS if effect.name == "outside_slow_memory"), (0.3,))


@pytest.mark.parametrize(
    ("saved", "keeps", "stays"), [(249.0, 199.0, True), (251.0, 201.0, True), (251.0, 199.0, False)]
)
def test_a_rival_contests_by_a_quarter_where_half_the_worth_is_gone(monkeypatch, saved, keeps, stays):
    """1000 squares are left above the floor; the name saves 400 alone, and `keeps` beside the rival."""
    name, beside = ("torsion_spring",), ("outside_slow_memory", "torsion_spring")
    squares = {name: 1100.0, (): 1500.0, beside[:1]: 1100.0 - saved, beside: 1100.0 - saved - keeps}
    table = Table(monkeypatch, squares, [RIVAL])
    left = contested(table.fit(None, Hypothesis((SPRING,))), evidence(made(level(1500.0))))
    assert left.hypothesis.names == (name if stays else ())


@pytest.mark.parametrize(("lost", "goes"), [(79.0, True), (81.0, False)])
def test_a_simpler_form_takes_the_place_of_what_saves_no_more_than_chance(monkeypatch, lost, goes):
    asymmetric = term("direction_dependent_friction")
    names = ("torque_offset",)
    table = Table(monkeypatch, {(asymmetric.effect.name,): 100.0, names: 100.0 + lost})
    left = simpler(table.fit(None, Hypothesis((asymmetric,))), evidence(made(level(500.0))))
    assert left.hypothesis.names == (names if goes else (asymmetric.effect.name,))


@pytest.mark.parametrize(
    ("chi", "there", "stays"), [(0.9, 1.24, True), (0.9, 1.26, False), (2.0, 2.4, True), (2.0, 2.6, False)]
)
def test_a_holdout_a_quarter_further_above_its_noise_lacks_what_an_event_stood_for(monkeypatch, chi, there, stays):
    Table(monkeypatch, {(): 100.0 * there**2})
    fitted = made(level(100.0 * chi**2), EVENT)
    left = not_in_holdout(fitted, evidence(made(level(1000.0)), SimpleNamespace()))
    assert left.hypothesis.names == (("load_torque_event",) if stays else ())


@pytest.mark.parametrize(
    ("start", "stop", "stays"), [(1.24, 1.74, True), (1.26, 1.76, False), (0.74, 1.24, False), (0.76, 1.26, True)]
)
def test_an_event_of_both_recordings_overlaps_by_half(monkeypatch, start, stop, stays):
    """The recording's lasts from 1 to 1.5 s."""
    Table(monkeypatch, {(): 400.0, ("load_torque_event",): 100.0}, [term("load_torque_event", start, stop)])
    left = not_in_holdout(made(level(100.0), EVENT), evidence(made(level(1000.0)), SimpleNamespace()))
    assert left.hypothesis.names == (("load_torque_event",) if stays else ())


@pytest.mark.parametrize(
    ("excess", "saved", "beside", "stays"),
    [
        (10000.0, 4999.0, (), True),
        (10000.0, 5001.0, (), False),
        (20000.0, 14374.0, (), True),
        (20000.0, 14376.0, (), False),
        (20000.0, 19000.0, (term("backlash", 0.01, 300.0, 0.5, 0.0),), True),
    ],
    ids=["less than half", "half", "1.25 floors left", "less left", "beside what leaves bursts"],
)
def test_a_wave_whose_relatives_explain_half_the_remainder_and_leave_noise_is_of_the_wrong_form(
    monkeypatch, excess, saved, beside, stays
):
    """Of 10000 rows with a noise of 1: half of what stands above, so that less than 1.5625 a row is left."""
    terms = (*beside, term("cogging_torque", 6.0))
    fitted = made(level(10000.0 + excess, 10000), *terms)
    fitted.__dict__.update({"seen": lambda *_, **__: np.zeros((10000, 10)), "gains": lambda *_: np.array([saved])})
    Table(monkeypatch, {(): 40000.0})
    left = wrong_form(fitted, evidence(made(level(40000.0, 10000))))
    assert left.terms == (terms if stays else ())
