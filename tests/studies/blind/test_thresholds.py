"""Thresholds are found in the rules, changed one at a time and put back; a variant's names are counted as the set's."""

import pytest

from bench.diagnosis.policy import Policy
from bench.diagnosis.recordings import Recordings, fit_bare
from tests.diagnosis.constructed import RIG, moved, recorded, wave
from tests.studies.blind.thresholds import AS_IS, Named, Tally, key, markdown, named, sample, tried
from tests.studies.blind.variants import thresholds

TRUTHS = [{"group": "single", "effects": ["unbalance"]}, {"group": "null", "effects": []}]


def test_every_threshold_says_what_it_decides():
    found = thresholds()
    assert {"chance", "number", "none", "remainder"} <= {each.name for each in found}
    assert all(each.decides for each in found)


@pytest.mark.parametrize("threshold", thresholds(), ids=lambda each: f"{each.owner}.{each.name}")
def test_one_threshold_changes_and_comes_back(threshold):
    before = thresholds()
    with threshold.times(2.0) as policy:
        changed = [each.value for each in thresholds()] != [each.value for each in before]
        assert changed is not (policy != Policy())
        assert changed is (threshold.owner != "Policy")
    assert thresholds() == before


def test_a_sample_holds_every_effect_and_group():
    drawn = sample(1, 8.0, 6)
    assert len({case.hidden.effects[0].name for case in drawn if case.name.startswith("single")}) == 21
    assert {case.name.split("-")[0] for case in drawn} == {"single", "pair", "null", "outside"}


def test_right_and_wrong_names_are_counted():
    assert str(Tally.of(TRUTHS, [Named(("unbalance",)), Named(("backlash",))])) == "1 0 0 0 0, 1"
    outside = [{"group": "outside", "effects": ["vibration"]}]
    assert str(Tally.of(outside, [Named((), True)])) == "0 0 0 1 0, 0"
    assert str(Tally.of(outside, [Named((), False)])) == "0 0 0 0 0, 0"


def test_a_recording_is_named_under_a_policy():
    recordings = Recordings.of([recorded(moved(), wave(0.02, 7.0))], RIG, None)
    found = tried(recordings, fit_bare(recordings.rows), Policy())
    assert named(recordings, found, Policy()) == Named(("cogging_torque",))


def test_a_threshold_that_changes_nothing_is_marked():
    keys = [AS_IS, *(key(each, factor) for each in thresholds() for factor in each.factors)]
    same = [dict.fromkeys(keys, Named(("unbalance",))), dict.fromkeys(keys, Named())]
    same[0]["Policy.chance half"] = Named(("unbalance", "backlash"))
    rows = markdown(TRUTHS, same, "command").splitlines()
    idle = [row for row in rows if "changes nothing here" in row]
    assert len(idle) == len(thresholds()) - 1
    assert next(row for row in rows if row.startswith("| Policy.chance")).split("|")[4:7] == [
        " 1 0 1 0 0, 0 ",
        "  ",
        " 0 0 1 0 0, 1 ",
    ]
