"""Two states held against each other: what alarms, what does not, and what nobody can tell."""

import math
from dataclasses import replace

import pytest
from scipy.stats import norm

from bench.baseline.check import Allowed, compare
from bench.baseline.state import VELOCITY_GAP
from bench.comparison.difference import Measured
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.report.check import headline
from bench.rig.rig import Rig
from tests.baseline.states import VALUES, GivenObserved, named, state

RIG = {"name": "a", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A"}}


def checked(baseline, now, rate=0.01, observed=None, **check):
    rig = Rig.of({**RIG, "check": check})
    return compare(baseline, observed or GivenObserved(now), Allowed.of(rig), rate)


def results(found):
    return {one.name: one.result for one in found.comparisons}


COGGING = {"amplitude": 0.05, "harmonic": 6.0, "phase": 1.0}


def cogged(rms=0.03, factors=None, **changed):
    """A state with cogging of so much torque - N*m."""
    return state(factors, [named("cogging_torque", rms, **{**COGGING, **changed})], "explained")


COULOMB, INERTIA, GAP = "coulomb_friction_torque", "moment_of_inertia", "torque_gap"
FASTER = {"top_speed": 1.5}


@pytest.mark.parametrize(
    ("changed", "motion", "check", "rate", "result"),
    [
        ({}, {}, {}, 0.01, "same"),
        ({COULOMB: 1.1}, {}, {}, 0.01, "changed"),
        ({INERTIA: 0.98}, {}, {}, 0.01, "changed"),
        ({INERTIA: 1.002}, {}, {}, 0.01, "same"),  # within the margin
        ({COULOMB: 1.035}, {}, {}, 0.01, "undecided"),
        ({COULOMB: 1.1}, {}, {"margin": {COULOMB: "15 %"}}, 0.01, "same"),
        ({COULOMB: 1.1}, {}, {"margin": {COULOMB: "10 mN*m"}}, 0.01, "same"),
        ({COULOMB: 1.1}, {}, {"between": {COULOMB: "5 %"}}, 0.01, "undecided"),
        ({COULOMB: 1.075}, {}, {}, 0.2, "changed"),
        ({COULOMB: 1.075}, {}, {}, 1e-6, "undecided"),
        ({COULOMB: 1.1}, FASTER, {}, 0.01, "undecided"),
        ({COULOMB: 2.0}, FASTER, {}, 0.01, "changed"),
        ({GAP: 5.0}, FASTER, {}, 0.01, "undecided"),
        ({GAP: 3.0}, {}, {}, 0.01, "changed"),
        ({GAP: 2.0}, {"floor": 0.01}, {}, 0.01, "undecided"),  # louder sensors are no gap
        ({GAP: 26.0}, {"rms_acceleration": 1.15}, {}, 0.01, "changed"),  # a dead zone that swallows some of the motion
        ({GAP: 26.0}, {"rms_acceleration": 1.0 / 1.15}, {}, 0.01, "changed"),
        ({GAP: 5.0}, {"rms_acceleration": 1.3}, {}, 0.01, "changed"),
        ({GAP: 2.5}, {"rms_acceleration": 1.3}, {}, 0.01, "undecided"),  # 1.3**3 = 2.2: the motion may do that
        ({GAP: 0.2}, {"rms_acceleration": 1.15}, {}, 0.01, "undecided"),
        ({GAP: 26.0}, {"rms_acceleration": 1.5}, {}, 0.01, "undecided"),  # nobody knows what so much more comes to
    ],
)
def test_a_change_is_one_beyond_margin_errors_and_what_another_motion_makes(changed, motion, check, rate, result):
    found = checked(state(), state(changed, **motion), rate, **check)
    assert found.result == result
    assert {results(found)[name] for name in changed} <= {result}
    assert motion or set(results(found).values()) <= {result, "same"}
    assert sum(one == "changed" for one in results(found).values()) == (result == "changed")
    if result == "changed":
        assert ("rose" if max(changed.values()) > 1.0 else "fell") in headline(found)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"margin": {"coulomb_friction": "2 %"}}, "did you mean 'coulomb_friction_torque'"),
        ({"margin": {"moment_of_inertia": "2 N*m"}}, "check.margin.moment_of_inertia"),
        ({"between": {"moment_of_inertia": "-1 kg*m**2"}}, "zero or above"),
    ],
)
def test_a_wrong_margin_is_reported_where_it_stands(table, message):
    with pytest.raises(InputError, match=message):
        checked(state(), state(), **table)


def test_another_rig_is_reported_and_decides_nothing():
    now = replace(state({"moment_of_inertia": 1.5}), rig={"kind": "rotary", "motor.torque_constant": "0.9"})
    found = checked(state(), now)
    assert found.result == "undecided"
    assert set(results(found).values()) == {"undecided"}
    assert "motor.torque_constant: 0.8 -> 0.9" in headline(found)


def test_an_effect_appears_beside_another_motion_where_its_torque_is_more_than_that_motion_makes_of_what_was_hidden():
    """The baseline hides up to 2.5 mN*m, of which 1.3**3 makes 5.5."""
    for torque, result in ((0.03, "changed"), (0.0056, "undecided")):
        now = state(None, [named("cogging_torque", torque, **COGGING)], "explained", top_speed=1.3)
        found = checked(state(), now, observed=GivenObserved(now))
        assert results(found)["cogging_torque (harmonic 6)"] == result


def test_an_effect_that_the_baseline_would_have_shown_has_appeared():
    now = cogged()
    found = checked(state(), now, observed=GivenObserved(now, factors={"torque_gap": 6.0}))
    assert found.result == "changed"
    assert [effect.name for effect, _ in found.appeared] == ["cogging_torque"]
    assert headline(found).startswith("Cogging torque (harmonic 6) appeared: amplitude 0.05 N*m (0.03 N*m RMS")


def test_an_effect_on_the_edge_of_its_name_is_no_alarm():
    now = GivenObserved(cogged(0.0022))
    found = checked(state(), now.state, observed=now)
    assert found.result == "undecided"
    assert "may have hidden" in headline(found)
    before = cogged(0.0022)
    gone = checked(before, state(), observed=GivenObserved(state(), torques={"cogging_torque": 0.0021}))
    assert gone.result == "undecided"  # the verdict differs, and nothing else
    assert results(gone)["cogging_torque (harmonic 6)"] == "same"


def test_an_effect_that_makes_no_torque_any_more_is_gone():
    before = cogged()
    found = checked(before, state(), observed=GivenObserved(state(), torques={"cogging_torque": 0.0005}))
    assert found.result == "changed"
    assert [effect.name for effect, _ in found.gone] == ["cogging_torque"]
    assert "is gone" in headline(found)


def test_effects_that_one_recording_cannot_tell_apart_are_no_change():
    lag = named("current_loop_lag", 0.02, ["velocity_filter_lag"], time_constant=2e-3)
    other = named("velocity_filter_lag", 0.0202, time_constant=2e-3)
    found = checked(state(None, [lag], "explained"), state(None, [other], "explained"))
    assert found.result == "same"
    assert not found.appeared
    assert not found.gone


def test_angles_mean_nothing_and_amplitudes_do():
    before = cogged()
    turned = cogged(phase=2.5)
    assert checked(before, turned).result == "same"
    stronger = cogged(0.09, amplitude=0.15)
    found = checked(before, stronger)
    assert headline(found).startswith("Cogging torque (harmonic 6): amplitude rose from 0.05 to 0.15 N*m")


def test_what_happens_once_is_no_change_of_the_axis():
    event = named("load_torque_event", 0.05, torque=0.3, start=1.0, end=1.5)
    assert checked(state(None, (), "explained"), state(None, [event], "explained")).result == "same"


def test_a_verdict_that_alone_differs_decides_nothing():
    assert checked(state(), state(verdict="unexplained_remainder")).result == "undecided"


def test_another_unit_is_not_compared():
    now = state()
    quantities = {**now.quantities, "moment_of_inertia": Measured(0.002, "A*s**2/rad", 1e-6)}
    assert results(checked(state(), replace(now, quantities=quantities)))["moment_of_inertia"] == "undecided"


def test_what_is_not_determined_now_is_not_called_the_same():
    now = state()
    observed = {name: one for name, one in now.quantities.items() if name != "coulomb_friction_torque"}
    found = checked(state(), replace(now, quantities=observed))
    assert found.result == "undecided"
    (missing,) = (one for one in found.comparisons if one.name == "coulomb_friction_torque")
    assert (missing.result, missing.now, missing.margin) == ("undecided", None, 0.0)
    assert "it is not determined now" in headline(found)


def chances(found):
    return {one.name: one.chance for one in found.comparisons}


def both_tails(away, margin, error):
    """Of a normal distribution: |D| >= away where the true one is the margin."""
    return norm.sf((away - margin) / error) + norm.sf((away + margin) / error)


def appeared(torque):
    """Cogging of so much torque - N*m - where the baseline names none; with its effects alone friction is as it was."""
    now = cogged(torque, {COULOMB: 1.15})
    return checked(state(), now, observed=GivenObserved(now, factors={"coulomb_friction_torque": 1.0 / 1.15}))


@pytest.mark.parametrize(("torque", "sure"), [(0.0022, False), (0.0033, False), (0.0036, True)])
def test_a_name_is_sure_at_the_rate_of_the_family_and_not_at_that_of_one(torque, sure):
    """Between the two rates friction still is compared under both sets of effects, beyond them under its own."""
    found = appeared(torque)
    # own errors of 1e-4 each, 5 % of the torque from recording to recording; seen from 0.0025 N*m on
    chance = both_tails(torque, 0.0025, math.sqrt(2e-8 + 2.0 * (0.05 * torque) ** 2))
    assert chances(found)["cogging_torque (harmonic 6)"] == pytest.approx(chance)
    assert bool(chance <= 0.01 / found.family) is sure
    assert bool(chance < 0.01) is (torque > 0.0025)
    assert results(found)["coulomb_friction_torque"] == ("changed" if sure else "undecided")


@pytest.mark.parametrize("effects", [(), (named("cogging_torque", 0.03, **COGGING),)])
def test_velocity_gaps_are_held_against_each_other_where_both_models_have_the_same_effects(effects):
    simulated = {VELOCITY_GAP: Measured(0.01, "rad/s", 1e-4)}
    before, now = (replace(each, quantities=each.quantities | simulated) for each in (state(), state(None, effects)))
    assert (VELOCITY_GAP in results(checked(before, now))) is not bool(effects)


def test_the_family_is_all_that_could_have_alarmed():
    """Quantities of the baseline, names that differ, quantities of names that both have, and effects nobody named."""
    effects = set(catalogue())
    assert checked(state(), state()).family == 4 + len(effects)
    assert appeared(0.0036).family == 4 + 1 + len(effects) - 1
    cogging = named("cogging_torque", 0.03, **COGGING)
    assert checked(state(None, [cogging]), state(None, [cogging])).family == 4 + 1 + len(effects) - 1
    before = replace(state(), shows=None)
    assert checked(before, state()).family == 4


def test_a_torque_gap_has_to_rise_over_the_noise_floor_too():
    """1.8 times the torque, floors equal: (0.8 - 0.25)/(sqrt(2)*0.12) standard deviations of a ratio of floors."""
    found = checked(state(), state({"torque_gap": 1.8}))
    assert chances(found)["torque_gap"] == pytest.approx(both_tails(0.8, 0.25, math.sqrt(2.0) * 0.12))
    alone = both_tails(0.8 * 0.005, 0.25 * 0.005, math.sqrt(2e-8 + 2.0 * (0.04 * 0.005) ** 2))
    assert alone < 1e-6  # which is what it would be if sensors could not become louder
    half = checked(state(floor=0.0025), state({"torque_gap": 1.8}, floor=0.0025))  # over floors of half the gap
    assert chances(half)["torque_gap"] == pytest.approx(both_tails(1.6, 0.5, math.sqrt(2.0) * 0.12 * 2.0))


def test_presets_are_shares_of_the_baselines_value():
    found = {one.name: one for one in checked(state(), state()).comparisons}
    for name, value, margin, between in (
        ("moment_of_inertia", 1.5e-3, 0.005, 0.001),
        ("viscous_friction_coefficient", 8e-4, 0.15, 0.03),
        ("coulomb_friction_torque", 0.06, 0.03, 0.0075),
        ("torque_gap", 0.005, 0.25, 0.04),
    ):
        own = VALUES[name][2]
        assert found[name].margin == pytest.approx(margin * value)
        assert found[name].difference.std_error == pytest.approx(math.sqrt(2.0 * (own**2 + (between * value) ** 2)))


def test_a_margin_is_at_least_a_thousandth_of_the_motions_torque():
    """rms_effort 0.7 N*m at 400 rad/s**2 and 60 rad/s, a hundred times as much as these parameters make of it."""
    found = {one.name: one for one in checked(state(rms_effort=100.0), state(rms_effort=100.0)).comparisons}
    assert found["moment_of_inertia"].margin == pytest.approx(70.0 * 1e-3 / 400.0)
    assert found["viscous_friction_coefficient"].margin == pytest.approx(70.0 * 1e-3 / 60.0)
    assert found["coulomb_friction_torque"].margin == pytest.approx(70.0 * 1e-3)
    assert found["torque_gap"].margin == pytest.approx(0.25 * 0.005)


def test_another_motion_counts_five_times_the_spread_of_each():
    own, between = VALUES["coulomb_friction_torque"][2], 0.0075 * 0.06
    for factor, times in ((1.09, 1.0), (1.11, 26.0), (1.0 / 1.11, 26.0)):
        found = checked(state(), state(top_speed=factor))
        one = next(one for one in found.comparisons if one.name == "coulomb_friction_torque")
        assert one.difference.std_error == pytest.approx(math.sqrt(2.0 * (own**2 + times * between**2)))
    effort = checked(state(), state(rms_effort=2.0, cutoff=2.0))  # what follows from noise and the axis' own change
    assert not effort.conditions


def test_quantities_of_effects_have_margins_of_a_quarter():
    for factor, result in ((1.1, "same"), (1.25, "undecided"), (1.8, "changed")):
        found = checked(cogged(), cogged(amplitude=0.05 * factor))
        (one,) = (one for one in found.comparisons if "amplitude" in one.name)
        assert (one.result, one.margin) == (result, pytest.approx(0.25 * 0.05))
        own = math.hypot(0.01 * 0.05, 0.01 * 0.05 * factor)
        assert one.difference.std_error == pytest.approx(math.hypot(own, math.sqrt(2.0) * 0.05 * 0.05))


def test_the_torque_of_an_effect_that_is_gone_is_compared_at_a_quarter_of_it():
    before = cogged()
    found = checked(before, state(), observed=GivenObserved(state(), torques={"cogging_torque": 0.02}))
    (pair,) = found.gone
    error = math.sqrt(2e-8 + 2.0 * (0.05 * 0.03) ** 2)
    assert pair[1].margin == pytest.approx(0.25 * 0.03)
    assert pair[1].chance == pytest.approx(both_tails(0.01, 0.25 * 0.03, error))


def test_waves_are_the_same_within_a_hundredth_of_their_harmonic():
    before = cogged()
    for harmonic, same in ((6.05, True), (6.07, False)):
        now = cogged(harmonic=harmonic)
        found = checked(before, now, observed=GivenObserved(now, torques={"cogging_torque": 1e-4}))
        assert (not found.appeared and not found.gone) is same


def test_effects_outside_the_torque_balance_come_and_go_without_an_alarm():
    lag = replace(named("current_loop_lag", 0.0, time_constant=2e-3), torque=None, shape=None)
    now = state(None, [lag], "explained")
    found = checked(state(), now, observed=GivenObserved(now))
    assert found.result == "undecided"
    assert "found in its signals only" in headline(found)
    back = checked(now, state(), observed=GivenObserved(state()))
    assert back.result == "undecided"
    assert "its strength is not known" in headline(back)


def test_comparisons_stand_worst_first_and_alike_by_chance():
    now = state({"coulomb_friction_torque": 1.2, "moment_of_inertia": 1.0069, "viscous_friction_coefficient": 1.2})
    found = checked(state(), now)
    assert [one.result for one in found.comparisons] == ["changed", "undecided", "undecided", "same"]
    assert [one.chance for one in found.comparisons[1:3]] == sorted(one.chance for one in found.comparisons[1:3])


def test_chances_are_held_against_the_rate_by_holms_procedure():
    """The surest against the rate over the family; the next against the rate over one fewer."""
    now = state({"coulomb_friction_torque": 1.0756, "moment_of_inertia": 1.1})
    found = checked(state(), now)
    chance = chances(found)["coulomb_friction_torque"]
    assert chances(found)["moment_of_inertia"] < 1e-9
    for rate, result in ((1.001, "changed"), (0.999, "undecided")):
        again = checked(state(), now, rate=chance * (found.family - 1) * rate)
        assert results(again)["coulomb_friction_torque"] == result
