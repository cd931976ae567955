"""The study draws, keeps and counts as it says."""

import json
from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.diagnosis.probability import Probabilities
from bench.effects.catalogue import catalogue
from bench.trace.trace import Trace
from bench.validation.independent.effects import LoadDependentFriction, TorqueOffset
from bench.validation.injection import INJECTABLE
from tests.shared import needs_shared
from tests.studies.blind.score import same
from tests.studies.injected.__main__ import first
from tests.studies.injected.cases import (
    FAILED,
    NONE,
    STRENGTHS,
    UNABLE,
    Case,
    Known,
    Row,
    believed,
    draw,
    keep,
    kept,
    possible,
    write_case,
)
from tests.studies.injected.sources import Source, real
from tests.studies.injected.stability import HALVES, NOISE, WHOLE, Answer, compared, markdown, variants
from tests.studies.injected.table import calibration_error, headline, holds, pairs, strictly
from tests.studies.nuisance.realistic import one
from tests.validation.test_into import OWN, found

LOADED = LoadDependentFriction(0.1)
KNOWN = Known(**vars(OWN))
CASE = Case("axis/r1", "cogging_torque", 2.0, 7)
ROW = Row(
    CASE,
    "right",
    ("cogging_torque",),
    "explained",
    probabilities={"cogging_torque": 0.9},
    seconds=1.5,
    quantities={"amplitude": (1, 2, 0, 3)},
    sets=(("cogging_torque",), None),
)


def test_every_effect_meets_every_recording_at_every_strength_once():
    cases = draw(["one", "two"], (), 1)
    assert len(cases) == len(set(cases)) == 2 * len(INJECTABLE) * len(STRENGTHS)
    assert cases != draw(["one", "two"], (), 2)
    assert {case.own_seed for case in draw(["one"], (), 1)} <= {case.own_seed for case in cases}


def test_rows_outlast_a_run_that_is_killed(tmp_path):
    path = tmp_path / "rows.jsonl"
    failed = replace(ROW, case=replace(CASE, strength=5.0), fate=FAILED)
    for row in (ROW, failed):
        keep(path, row)
    path.write_text(path.read_text(encoding="utf-8") + '{"case": {"sour', encoding="utf-8")
    assert list(kept(path)) == [ROW]  # what failed is tried again
    assert list(kept(tmp_path / "none")) == []


def test_a_row_goes_on_after_one_that_was_cut_off(tmp_path):
    path = tmp_path / "rows.jsonl"
    path.write_text('{"case": {"sour', encoding="utf-8")
    keep(path, ROW)
    assert list(kept(path)) == [ROW]


def test_the_first_cases_that_axes_can_have_are_drawn_ones_up_to_the_last_of_them(tmp_path):
    path, fates = tmp_path / "rows.jsonl", [UNABLE, "right", UNABLE, UNABLE, "missed", "wrong", UNABLE]
    rows = [replace(ROW, case=replace(CASE, strength=float(k)), fate=fate) for k, fate in enumerate(fates)]
    for row in rows:
        keep(path, row)
    items = [(row.case, None, KNOWN) for row in rows]
    assert first(items, 1, path, 1) == rows[:2]
    assert first(items, 2, path, 1) == rows[:5]
    assert first(items, 9, path, 1) == rows


@pytest.mark.parametrize(
    ("told", "error"),
    [([(1.0, True)] * 3 + [(1.0, False)], 0.25), ([(0.5, True), (0.5, False)], 0.0), ([(0.9, True)], 0.1), ([], 0.0)],
)
def test_calibration_error(told, error):
    assert calibration_error(told) == pytest.approx(error)


def test_what_no_catalogue_holds_is_no_name():
    flagged = replace(ROW, probabilities={NONE: 1.0, "backlash": 0.2})
    assert pairs([ROW, flagged]) == [(0.9, True), (0.2, False)]
    assert "| mean probability of the true name | 0.450 |" in headline([ROW, flagged], ())


def test_what_a_simulated_recording_holds_besides_is_no_false_name():
    said = {"cogging_torque": 0.9, "torque_offset": 0.6, "backlash": 0.2}
    beside = replace(ROW, probabilities=said, hidden=("direction_dependent_friction",))  # the offset's twin
    assert pairs([beside]) == [(0.9, True), (0.6, True), (0.2, False)]
    assert pairs([beside], hidden=False) == [(0.9, True), (0.2, False)]
    every = pairs([beside], hidden=False, every=True)
    assert sorted(every)[-2:] == [(0.2, False), (0.9, True)]
    assert len(every) == len(same([*catalogue()])) - 1  # friction by direction and an offset look alike


@pytest.mark.parametrize(
    ("sets", "held"),
    [
        ([{"cogging_torque"}], True),
        ([{"backlash"}, {"cogging_torque", "unbalance"}], True),
        ([{"cogging_torque", "backlash"}, {"unbalance"}, None], False),
    ],
)
def test_a_set_holds_the_effect_and_no_more_than_is_there(sets, held):
    sets = tuple(each if each is None else tuple(each) for each in sets)
    assert holds(replace(ROW, sets=sets, hidden=KNOWN.beside)) == held


def test_beside_a_remainder_of_a_real_axis_none_of_the_catalogue_is_the_truth():
    named, open_ = (replace(ROW, sets=sets) for sets in ((("cogging_torque",),), ((), None)))
    assert holds(named) and strictly(named, {"axis/r2"}) and not strictly(named, {"axis/r1"})
    assert strictly(open_, {"axis/r1"}) and not holds(open_)


def test_names_are_compared_with_variants_and_other_rounds():
    axis = [Source("axis", f"axis/r{k}", None, None) for k in (1, 2)]
    one, two, none = Answer(("a",), {"a": 0.99}), Answer(("a", "b"), {"a": 1.0, "b": 0.9}), Answer((), {"a": 0.04})
    said = {
        "axis/r1": {WHOLE: one, NOISE: one, HALVES[0]: two, HALVES[1]: None},
        "axis/r2": {WHOLE: one, NOISE: none, HALVES[0]: one, HALVES[1]: one},
    }
    assert ("rounds", "axis/r1, axis/r2", one, one) in list(compared(axis, said))
    text = markdown(axis, said, "command")
    for line in (
        f"| {NOISE} | 1 | 0 | 1 | 0 |",
        f"| {HALVES[0]} | 1 | 1 | 0 | 0 |",
        f"| {HALVES[1]} | 1 | 0 | 0 | 1 |",
    ):
        assert line in text
    assert "| rounds | 1 | 0 | 0 | 0 |" in text


def test_variants_keep_all_samples_and_add_the_noise_that_there_is():
    time, rng = 1e-3 * np.arange(4000), np.random.default_rng(1)
    signals = {"velocity": np.sin(time) + 0.01 * rng.normal(size=time.size), "current": np.cos(time)}
    trace = Trace(time, signals, {"velocity": "rad/s", "current": "A"}, "made")
    made = dict(variants(trace, 3))
    assert len(made[HALVES[0]]) + len(made[HALVES[1]]) == len(trace)
    assert np.std(made[NOISE]["velocity"] - trace["velocity"]) == pytest.approx(0.01, rel=0.1)


def test_a_case_is_written_with_its_truth(tmp_path):
    rig = tmp_path / "rig.toml"
    rig.write_text(
        'name = "axis"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\n[trace.columns]\ntime = "t"\n'
    )
    source = Source("axis", "axis/r1", tmp_path / "run.csv", rig)
    swings = OWN.host.trace.with_signals({"current": np.cos(5.0 * OWN.host.trace.time)}, {})
    own = replace(KNOWN, host=replace(KNOWN.host, trace=swings))
    assert write_case(tmp_path / "made", CASE, source, own)
    assert not write_case(tmp_path / "none", replace(CASE, effect="unbalance"), source, own)  # it has one
    truth = json.loads((tmp_path / "made" / "truth.json").read_text(encoding="utf-8"))
    assert (truth["effects"], truth["group"], truth["own"]) == (["cogging_torque"], "injected", ["unbalance"])
    assert truth["rms_beyond_base"] == pytest.approx(2.0 * own.left, rel=0.1)
    known = bench.load_rig(tmp_path / "made" / "rig.toml")
    made, wave = bench.read(tmp_path / "made" / "run1.csv.gz", known.trace), truth["quantities"]["cogging_torque"]
    added = (made["current"] - swings["current"]) * own.host.axis.torque_constant
    expected = wave["amplitude"] * np.sin(wave["harmonic"] * swings["position"] + wave["phase"])
    assert added == pytest.approx(expected, abs=1e-4)


@needs_shared
def test_the_real_recordings_are_there():
    assert [source.name for source in real() if not source.path.exists() or not source.rig.exists()] == []


def test_an_axis_has_one_coupling_and_shows_one_lag_of_its_current():
    own = replace(KNOWN, names=("backlash",), hidden=("current_loop_lag",))
    assert not possible("elastic_coupling", own)
    assert not possible("current_filter_lag", own)
    assert possible("cogging_torque", own)
    assert possible("elastic_coupling", KNOWN)


def test_how_likely_the_effect_is_and_others_that_are_new():
    def probabilities(*said, **more):
        diagnosis = found(*said, **more)
        names = frozenset(one.name for one in diagnosis.effects)
        sets = {names: 0.9, frozenset({"torsion_spring"}): 0.06}
        diagnosis.probabilities = Probabilities(sets, 0.04)
        return believed(diagnosis, "cogging_torque", OWN.names)

    others = {"torsion_spring": 0.06, NONE: 0.04}
    assert probabilities("explained", "cogging_torque") == {"cogging_torque": 0.9, **others}
    assert probabilities("explained", "backlash") == {"cogging_torque": 0.0, "backlash": 0.9, **others}
    assert probabilities("explained", "unbalance") == {"cogging_torque": 0.0, **others}  # its own
    twin = probabilities("explained", "torque_ripple", ambiguous=("cogging_torque",))
    assert twin == {"cogging_torque": 0.9, **others}


def test_a_simulated_axis_is_recorded_once_more_with_the_effect():
    """Friction by the load carries an offset that is put in, too; put into the recording it would not."""
    drawn = one(3, 0)
    short = replace(drawn.hidden, effects=(LOADED,), duration=2.0)
    source = Source("made", "made", None, None, "", replace(drawn, hidden=short), 3)
    assert source.hidden == ("load_dependent_friction",)
    axis = drawn.hidden.axis
    made, alone = (source.made_with(None, TorqueOffset(share * axis.coulomb)) for share in (0.5, 0.0))
    assert np.mean(made["current"] - alone["current"]) * axis.torque_constant == pytest.approx(
        0.5 * axis.coulomb, rel=0.2
    )
