"""Names that were nearest when nothing stood beside them are exchanged for those that leave less."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis import search as searching
from bench.diagnosis.policy import Policy, worth
from bench.diagnosis.probability import neighbourhood
from bench.diagnosis.search import Candidate, Step, exchanged, instead_of_each, search
from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term
from tests.diagnosis.constructed import COULOMB, bare, likely, moved, recorded, wave
from tests.diagnosis.hand_made import made

EFFECTS = [catalogue()[name] for name in ("quadratic_drag", "cogging_torque", "stribeck_friction", "torque_offset")]
COGGING = Term(catalogue()["cogging_torque"], (7.0,))


def drag(motion):
    return 1e-4 * motion.velocity * np.abs(motion.velocity)


@pytest.mark.parametrize("wrong", [Term(catalogue()["stribeck_friction"], (8.0,)), Term(catalogue()["torque_offset"])])
def test_a_name_is_exchanged_for_the_one_that_leaves_less(wrong):
    without = bare(recorded(moved(), drag, wave(0.02, 7.0)))
    nearest = fit(without.rows, Hypothesis((wrong, COGGING)))
    found = exchanged(nearest, instead_of_each(nearest, EFFECTS, Policy()), Policy())
    assert found is not None
    assert sorted(found.hypothesis.names) == ["cogging_torque", "quadratic_drag"]
    assert found.chi < 1.1


def test_names_that_leave_noise_alone_stay():
    without = bare(recorded(moved(), drag, wave(0.02, 7.0)))
    right = fit(without.rows, Hypothesis((Term(catalogue()["quadratic_drag"]), COGGING)))
    assert exchanged(right, instead_of_each(right, EFFECTS, Policy()), Policy()) is None


@pytest.mark.parametrize(("share", "tried"), [(0.46, True), (0.44, False)])
def test_like_is_held_against_like(monkeypatch, share, tried):
    """A name that takes half as much at a grid's shape as it does once that is searched, and another at a grid's."""
    drags, offset = Term(catalogue()["quadratic_drag"]), Term(catalogue()["torque_offset"])
    named = fit(bare(recorded(moved(), drag, wave(0.02, 7.0))).rows, Hypothesis((drags, COGGING)))
    saved = worth(fit(named.rows, named.hypothesis.without(0)), named)
    found = [Candidate(drags, 0.5 * saved), Candidate(offset, share * saved)]
    monkeypatch.setattr(searching, "candidates", lambda *_: found)
    instead = [each.hypothesis.names for each in instead_of_each(named, EFFECTS, Policy())]
    assert instead == [("cogging_torque", "torque_offset")] * tried


def test_what_was_instead_of_each_as_the_only_name_is_weighed_too():
    """A slow axis' torque is friction: a wave of it hardly differs from a wave of torque, and a search takes one."""
    trace = recorded(
        moved(20.0, ((6.0, 0.1, 0.3),)), lambda motion: 0.2 * COULOMB * np.sin(motion.position) * motion.sign
    )
    found = likely(Policy(), trace, ["torque_ripple", "position_dependent_friction"]).names
    assert 0.1 < found["position_dependent_friction"] < 0.9
    assert 0.1 < found["torque_ripple"] < 0.9


def test_what_the_rows_decide_is_not_weighed_any_more():
    """By likelihood of independent rows, N*ln(chi'/chi): a name that leaves more is beyond any odds."""
    rows = bare(recorded(moved(), drag)).rows
    right, wrong = (fit(rows, Hypothesis((Term(catalogue()[name]),))) for name in ("quadratic_drag", "torque_offset"))
    assert wrong.chi > 1.3 * right.chi
    assert not Policy().undecided(right, wrong)
    assert Policy().undecided(right, right)
    assert Policy().undecided(wrong, right)


@pytest.mark.parametrize(("saved", "undecided"), [(0.95, True), (1.05, False)])
def test_what_more_numbers_save_by_chance_decides_nothing(saved, undecided):
    """An event has two numbers more than an offset; white noise of so many rows alone would speak for it."""
    noise, event = np.sqrt(0.01), Term(catalogue()["load_torque_event"], (1.0, 2.0))
    other = made(np.full(10_000, noise), Term(catalogue()["torque_offset"]), floor=2.0 * noise, white=noise)
    less = saved * Policy().by_chance(other, 2)
    one = made(np.full(10_000, np.sqrt(0.01 - less / 10_000)), event, floor=2.0 * noise, white=noise)
    assert Policy().undecided(one, other) == undecided
    assert Policy().undecided(other, one)


def test_what_was_as_good_as_an_earlier_name_is_weighed_with_what_it_needs_beside_it():
    """A name that came first, and a wave that is there only because of it, against the true one alone."""
    trace = recorded(moved(), wave(0.03, 3.0))
    rows = bare(trace).rows
    true, extra = (Term(catalogue()["cogging_torque"], (number,)) for number in (3.0, 11.0))
    wrong = fit(rows, Hypothesis((Term(catalogue()["unbalance"]), extra)))
    searched = replace(search(bare(trace), [], Policy()), instead=(fit(rows, Hypothesis((true, extra))),))
    ended = replace(searched, steps=(*searched.steps, Step(wrong)))
    tried = [sorted(each.hypothesis.names) for each in neighbourhood(ended, frozenset(), Policy())]
    assert ["cogging_torque", "cogging_torque"] in tried
    assert ["cogging_torque"] in tried


def test_a_result_is_weighed_against_itself_without_each_of_its_names():
    """Of those that come later a search has not tried it without the first."""
    trace = recorded(moved(), wave(0.03, 3.0), drag)
    searched = search(bare(trace), [catalogue()[name] for name in ("cogging_torque", "quadratic_drag")], Policy())
    tried = [sorted(each.hypothesis.names) for each in neighbourhood(searched, frozenset(), Policy())]
    assert sorted(searched.last.hypothesis.names) == ["cogging_torque", "quadratic_drag"]
    assert ["cogging_torque"] in tried
    assert ["quadratic_drag"] in tried
