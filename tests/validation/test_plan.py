"""A run is the same whatever runs beside it, wherever; what is hidden follows the option."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.validation.independent.effects import KINDS
from bench.validation.plan import HIDEABLE, Hiding, Plan
from bench.validation.validate import TOGETHER, carried_out, pieces, record, validate
from tests.validation.population import short

PLAN = Plan(5, population=short)


def test_a_case_depends_on_seed_and_index_alone():
    few = [PLAN.case(index) for index in (3, 1)]
    again = [PLAN.case(index) for index in range(4)]
    assert [case.axis for case in few] == [again[3].axis, again[1].axis]
    assert [case.sensors for case in few] == [again[3].sensors, again[1].sensors]
    assert Plan(6, population=short).case(1).axis != few[1].axis


def test_a_recording_is_the_same_bit_for_bit_alone_and_beside_others():
    cases = [PLAN.case(index) for index in range(6)]
    assert {case.plant for case in cases} == {"independent", "mujoco"}
    together = record(cases, PLAN.seed)
    for place in (0, 2, 5):
        (alone,) = record([cases[place]], PLAN.seed)
        assert alone.signals.keys() == together[place].signals.keys()
        assert all(np.array_equal(alone[name], together[place][name]) for name in alone.signals)


def test_pieces_hold_every_run_once():
    assert [index for piece in pieces(2 * TOGETHER + 3) for index in piece] == list(range(2 * TOGETHER + 3))


def test_what_is_reported_in_a_process_of_its_own_is_what_is_reported_here():
    shares = []
    found = validate(PLAN, 3, workers=1, progress=shares.append)
    assert found.runs == tuple(carried_out(PLAN, range(3)))
    assert shares == [1.0]


def test_names_are_hidden_in_turn_and_then_nothing():
    hiding = Hiding.parse("unbalance, backlash")
    axis, rng = PLAN.case(0).axis, np.random.default_rng(0)
    drawn = [hiding.drawn(index, rng, axis) for index in range(4)]
    assert drawn == [("unbalance",), ("backlash",), (), ("unbalance",)]
    assert Hiding.parse("all").names == HIDEABLE
    assert set(HIDEABLE) <= set(catalogue()) & set(KINDS)


def test_so_many_are_hidden_as_asked():
    rng = np.random.default_rng(0)
    axis = PLAN.case(0).axis
    counts = {len(Hiding.parse("1-3").drawn(index, rng, axis)) for index in range(40)}
    assert counts == {1, 2, 3}
    assert Hiding.parse("0").anything is False


@pytest.mark.parametrize("text", ["3-1", "9", "backlsh", "", "1-"])
def test_what_cannot_be_hidden_is_reported(text):
    with pytest.raises(InputError, match="allowed"):
        Hiding.parse(text)
