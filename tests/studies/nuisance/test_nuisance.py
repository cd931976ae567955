"""The nuisance set's own parts: a draw that repeats, damage that is what it says, and judgement."""

import numpy as np
import pytest

from tests.studies.nuisance.answer import Answer
from tests.studies.nuisance.draw import Case, draw, one
from tests.studies.nuisance.kinds import NUISANCES
from tests.studies.nuisance.nuisance import PERIOD
from tests.studies.nuisance.score import NEITHER, RIGHT, WRONG, judged
from tests.studies.nuisance.signals import FINE, Signals, noisy, sampled
from tests.studies.nuisance.table import cases_csv, markdown

SEED = 1


def case(name: str, place: int = 0, level: int = 0) -> Case:
    return one(SEED, name, level, place)


def answer(drawn: Case, error: float = 0.0, half_width: float = 1e-4, verdict: str = "", named=(), **more) -> Answer:
    true = drawn.axis.inertia
    value = true * (1.0 + error)
    return Answer(
        0,
        verdict=verdict or ("explained" if named else "nothing_missing"),
        named=tuple(named),
        inertia=(value, value - half_width * true, value + half_width * true),
        **more,
    )


def fine(drawn: Case, duration: float = 2.0) -> Signals:
    time = FINE * np.arange(round(duration / FINE))
    position, speed, _ = drawn.motion.at(time)
    current = drawn.axis.peak_current * np.sin(2.0 * np.pi * 3.0 * time)
    columns = {"position": position, "velocity": speed, "current": current}
    return Signals(time, columns | {"position_reference": position, "velocity_reference": speed})


def in_file(name: str, level: int = 0) -> tuple[Signals, Signals, Case]:
    """Columns that a nuisance leaves, those of a sound recorder, and the case."""
    drawn = case(name, level=level)
    exact, kind, rng = fine(drawn), drawn.kind, np.random.default_rng(0)
    sound = noisy(sampled(exact, PERIOD), drawn.axis, np.random.default_rng(2))
    seen = kind.exact(exact, drawn.strength, drawn.axis, rng)
    taken = noisy(kind.sampled(seen, drawn.strength, np.random.default_rng(1)), drawn.axis, np.random.default_rng(2))
    return kind.in_file(taken, drawn.strength, drawn.axis, rng), sound, drawn


def test_there_are_enough_of_them_and_each_says_how_the_world_makes_it():
    damaging = [kind for name, kind in NUISANCES.items() if name != "nuisance"]
    assert len(damaging) >= 25
    assert all(len(kind.strengths) >= 2 for kind in damaging)
    texts = [type(kind).__doc__ for kind in damaging]
    assert len({text for text in texts if text}) == len(damaging)


def test_a_case_is_the_same_however_many_are_drawn():
    few = {drawn.name: drawn for drawn in draw(7, 1)}
    more = {drawn.name: drawn for drawn in draw(7, 3)}
    assert len(more) == 3 * len(few)
    for name, drawn in few.items():
        assert repr(drawn.axis) == repr(more[name].axis)
        assert drawn.hidden == ""
        time = np.linspace(0.0, 0.5, 50)
        assert np.array_equal(drawn.motion.at(time), more[name].motion.at(time))


def test_effects_that_a_nuisance_takes_away_are_not_hidden_in_it():
    assert all(drawn.hidden not in drawn.kind.unsuited for seed in range(3) for drawn in draw(seed, 4))
    assert len({drawn.hidden for drawn in draw(1, 3)} - {""}) >= 19


@pytest.mark.parametrize("name", list(NUISANCES))
def test_every_nuisance_damages_something_and_leaves_columns_of_one_length(name):
    for level in range(len(NUISANCES[name].strengths)):
        found, sound, drawn = in_file(name, level)
        assert {values.size for values in found.columns.values()} == {found.time.size}
        columns = found.columns.keys() == sound.columns.keys()
        columns = columns and all(np.array_equal(found[key], values) for key, values in sound.columns.items())
        text = 'torque_constant = "1 N*m/A"\npeak_current = "1 A"\n\n[drive]\n'
        rig = drawn.kind.known(drawn.axis, drawn.strength) == drawn.axis
        rig = rig and drawn.kind.rig_text(text, drawn.axis, drawn.strength) == text
        stamps = np.array_equal(found.time, sound.time)
        motion = type(drawn.kind).motion is type(NUISANCES["nuisance"]).motion
        assert (columns and rig and stamps and motion) == (name == "nuisance")


def test_lost_samples_leave_regular_stamps_and_jumps_in_position():
    found, sound, _ = in_file("samples-lost", 1)
    lost = sound.time.size - found.time.size
    assert lost == round(0.005 * sound.time.size)
    assert np.ptp(np.diff(found.time)) < 1e-9
    assert found.time[-1] < sound.time[-1]


def test_filtered_current_settles_with_its_time_constant():
    drawn = case("current-filtered", level=1)
    step = fine(drawn).but(current=np.ones(round(2.0 / FINE)))
    filtered = drawn.kind.exact(step, drawn.strength, drawn.axis, np.random.default_rng(0))["current"]
    after = round(1e-3 / FINE)
    assert filtered[after] == pytest.approx(1.0 - np.exp(-1.0))


def test_averages_are_those_of_the_samples_before():
    drawn = case("averaged", level=0)
    ramp = fine(drawn)
    ramp = ramp.but(current=ramp.time)
    means = drawn.kind.sampled(ramp, drawn.strength, np.random.default_rng(0))
    assert means["current"][5] == pytest.approx(means.time[5] - 1.5 * FINE)
    assert np.diff(means.time) == pytest.approx(1e-3)


def test_a_tolerance_stands_in_the_rig():
    drawn = case("torque-constant-tolerance", level=1)
    text = drawn.kind.rig_text('torque_constant = "1 N*m/A"\n', drawn.axis, drawn.strength)
    assert f'"{1.1 * drawn.axis.torque_constant:.8g} +/- ' in text


def test_names_without_a_remainder_and_far_inertia_are_wrong():
    null, single = case("jitter"), case("jitter", 1)
    good = answer(null)
    assert judged(null, good, answer(null)).judgement == RIGHT
    assert judged(null, good, answer(null, named=["unbalance"])).judgement == WRONG
    beside = answer(null, named=["unbalance"], verdict="unexplained_remainder")
    assert judged(null, good, beside).judgement == NEITHER
    assert judged(null, good, answer(null, error=4e-4)).judgement == WRONG
    assert judged(null, answer(null, error=4e-4), answer(null)).judgement == WRONG
    assert judged(null, good, answer(null, error=0.02, half_width=0.05)).judgement == WRONG
    failed = answer(null, error=0.02, checks=(("velocity_is_derivative_of_position", "fail"),))
    assert judged(null, good, failed).judgement == NEITHER
    biased = answer(single, error=0.3)
    assert judged(single, biased, answer(single, named=[single.hidden])).judgement == RIGHT
    assert judged(single, biased, answer(single, verdict="nothing_missing")).judgement == NEITHER


def test_refusals_are_right_only_where_the_answer_is_lost():
    refused = Answer(1, said="no")
    lost, sound = case("current-sign"), case("hum")
    assert judged(lost, refused, refused).judgement == RIGHT
    assert judged(sound, refused, refused).judgement == NEITHER
    traceback = judged(lost, refused, Answer(70, said="ValueError: 1"))
    assert traceback.judgement == NEITHER
    assert traceback.fault


def test_remainders_are_right_only_where_no_effect_is_the_disturbance():
    for name, judgement in (("pickup", RIGHT), ("hum", NEITHER)):
        drawn = case(name)
        said = answer(drawn, verdict="unexplained_remainder")
        assert judged(drawn, answer(drawn), said).judgement == judgement


def test_a_fault_of_the_measurement_may_be_named_as_one():
    null, single = case("current-filtered"), case("current-filtered", 1)
    assert judged(null, answer(null), answer(null, named=["current_filter_lag"])).judgement == RIGHT
    assert judged(null, answer(null), answer(null, named=["backlash"])).judgement == WRONG
    both = answer(single, named=[single.hidden, "current_filter_lag"])
    assert judged(single, answer(single), both).judgement == RIGHT
    assert judged(single, answer(single), answer(single, named=["current_filter_lag"])).judgement == NEITHER


def test_a_wrong_torque_constant_may_be_reported_instead():
    null = case("torque-constant-wrong")
    off = answer(null, error=-0.2)
    assert judged(null, off, off).judgement == WRONG
    complaining = answer(null, error=-0.2, complaints=("torque_constant 0.8 against back_emf_constant 1",))
    assert judged(null, complaining, complaining).judgement == RIGHT


def test_results_are_reported():
    null = case("hum")
    scores = [
        judged(null, answer(null), answer(null)),
        judged(null, answer(null), answer(null, named=["unbalance"])),
    ]
    text = markdown(scores, "title", "command")
    assert "| right | 1 of 2, 50.0 % | 80 % |" in text
    assert "false name unbalance" in text
    assert len(cases_csv(scores).splitlines()) == 3
