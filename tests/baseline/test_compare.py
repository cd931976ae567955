"""Two states held against each other: what alarms, what does not, and what nobody can tell."""

from dataclasses import replace

import pytest

from bench.baseline.allowed import Allowed
from bench.baseline.compare import compare
from bench.baseline.measured import Measured
from bench.baseline.wording import headline
from bench.errors import InputError
from bench.rig.rig import Rig
from tests.baseline.states import GivenObserved, named, state

RIG = {"name": "a", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A"}}


def checked(baseline, now, rate=0.01, observed=None, **check):
    rig = Rig.of({**RIG, "check": check})
    return compare(baseline, observed or GivenObserved(now), Allowed.of(rig), rate)


def results(found):
    return {one.name: one.result for one in found.comparisons}


def test_an_axis_is_the_same_as_itself():
    found = checked(state(), state())
    assert found.result == "same"
    assert set(results(found).values()) == {"same"}
    assert found.family > 20  # effects that nobody named were looked for too


@pytest.mark.parametrize(("name", "factor"), [("coulomb_friction_torque", 1.1), ("moment_of_inertia", 0.98)])
def test_a_change_beyond_margin_and_errors_is_one(name, factor):
    found = checked(state(), state({name: factor}))
    assert found.result == "changed"
    assert results(found)[name] == "changed"
    assert sum(one == "changed" for one in results(found).values()) == 1
    assert ("rose" if factor > 1.0 else "fell") in headline(found)


def test_a_change_within_the_margin_is_none():
    assert checked(state(), state({"moment_of_inertia": 1.002})).result == "same"


def test_what_is_neither_shown_same_nor_changed_is_undecided():
    found = checked(state(), state({"coulomb_friction_torque": 1.035}))
    assert found.result == "undecided"
    assert results(found)["coulomb_friction_torque"] == "undecided"


def test_the_rig_file_says_what_matters():
    now = state({"coulomb_friction_torque": 1.1})
    assert checked(state(), now, margin={"coulomb_friction_torque": "15 %"}).result == "same"
    assert checked(state(), now, margin={"coulomb_friction_torque": "10 mN*m"}).result == "same"
    assert checked(state(), now, between={"coulomb_friction_torque": "5 %"}).result == "undecided"


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


def test_a_stricter_rate_alarms_later():
    now = state({"coulomb_friction_torque": 1.075})
    assert checked(state(), now, rate=0.2).result == "changed"
    assert checked(state(), now, rate=1e-6).result == "undecided"


def test_another_rig_is_reported_and_decides_nothing():
    now = replace(state({"moment_of_inertia": 1.5}), rig={"kind": "rotary", "motor.torque_constant": "0.9"})
    found = checked(state(), now)
    assert found.result == "undecided"
    assert set(results(found).values()) == {"undecided"}
    assert "motor.torque_constant: 0.8 -> 0.9" in headline(found)


def test_another_motion_widens_what_can_be_said():
    def moved(**factors):
        return state(factors, top_speed=1.5)

    assert checked(state(), moved(coulomb_friction_torque=1.1)).result == "undecided"
    assert checked(state(), moved(coulomb_friction_torque=2.0)).result == "changed"
    assert checked(state(), moved(torque_gap=5.0)).result == "undecided"


COGGING = {"amplitude": 0.05, "harmonic": 6.0, "phase": 1.0}


def test_an_effect_that_the_baseline_would_have_shown_has_appeared():
    now = state(None, [named("cogging_torque", 0.03, **COGGING)], "explained")
    found = checked(state(), now, observed=GivenObserved(now, factors={"torque_gap": 6.0}))
    assert found.result == "changed"
    assert [effect.name for effect, _ in found.appeared] == ["cogging_torque"]
    assert headline(found).startswith("Cogging torque (harmonic 6) appeared: amplitude 0.05 N*m (0.03 N*m RMS")


def test_an_effect_on_the_edge_of_its_name_is_no_alarm():
    now = GivenObserved(state(None, [named("cogging_torque", 0.0022, **COGGING)], "explained"))
    found = checked(state(), now.state, observed=now)
    assert found.result == "undecided"
    assert "may have hidden" in headline(found)
    before = state(None, [named("cogging_torque", 0.0022, **COGGING)], "explained")
    gone = checked(before, state(), observed=GivenObserved(state(), torques={"cogging_torque": 0.0021}))
    assert gone.result == "undecided"  # the verdict differs, and nothing else
    assert results(gone)["cogging_torque (harmonic 6)"] == "same"


def test_an_effect_that_makes_no_torque_any_more_is_gone():
    before = state(None, [named("cogging_torque", 0.03, **COGGING)], "explained")
    found = checked(before, state(), observed=GivenObserved(state(), torques={"cogging_torque": 0.0005}))
    assert found.result == "changed"
    assert [effect.name for effect, _ in found.gone] == ["cogging_torque"]
    assert "is gone" in headline(found)


def test_parameters_that_an_uncertain_name_moves_are_compared_with_both_sets_of_effects():
    now = state({"coulomb_friction_torque": 1.15}, [named("cogging_torque", 0.0022, **COGGING)], "explained")
    found = checked(state(), now, observed=GivenObserved(now, factors={"coulomb_friction_torque": 1.0 / 1.15}))
    assert results(found)["coulomb_friction_torque"] == "undecided"
    assert found.result == "undecided"


def test_effects_that_one_recording_cannot_tell_apart_are_no_change():
    lag = named("current_loop_lag", 0.02, ["velocity_filter_lag"], time_constant=2e-3)
    other = named("velocity_filter_lag", 0.0202, time_constant=2e-3)
    found = checked(state(None, [lag], "explained"), state(None, [other], "explained"))
    assert found.result == "same"
    assert not found.appeared
    assert not found.gone


def test_angles_mean_nothing_and_amplitudes_do():
    before = state(None, [named("cogging_torque", 0.03, **COGGING)], "explained")
    turned = state(None, [named("cogging_torque", 0.03, **{**COGGING, "phase": 2.5})], "explained")
    assert checked(before, turned).result == "same"
    stronger = state(None, [named("cogging_torque", 0.09, **{**COGGING, "amplitude": 0.15})], "explained")
    found = checked(before, stronger)
    assert headline(found).startswith("Cogging torque (harmonic 6): amplitude rose from 0.05 to 0.15 N*m")


def test_what_happens_once_is_no_change_of_the_axis():
    event = named("load_torque_event", 0.05, torque=0.3, start=1.0, end=1.5)
    assert checked(state(None, (), "explained"), state(None, [event], "explained")).result == "same"


def test_louder_sensors_are_no_gap():
    louder = state({"torque_gap": 2.0}, floor=0.01)
    assert results(checked(state(), louder))["torque_gap"] == "undecided"
    assert results(checked(state(), state({"torque_gap": 3.0})))["torque_gap"] == "changed"


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
    assert results(found)["coulomb_friction_torque"] == "undecided"
    assert "it is not told now" in headline(found)
