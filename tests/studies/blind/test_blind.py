"""The blind set's own parts: a draw that repeats, judgement, and true values in the diagnosis' quantities."""

import numpy as np
import pytest

from bench.validation.independent.effects import CATALOGUE
from tests.studies.blind.confusion import REMAINDER, counted, given
from tests.studies.blind.draw import GROUPS, draw, one
from tests.studies.blind.parameters import compared, expected
from tests.studies.blind.run import Outcome
from tests.studies.blind.score import score
from tests.studies.blind.table import cases_csv, false_names, markdown


def truth(*effects, group="single", **parameters):
    return {
        "effects": list(effects),
        "group": group,
        "severity": 0.4,
        "strength": "middle",
        "parameters": dict.fromkeys(effects, parameters),
        "inertia": 2.0,
        "viscous_friction": 0.01,
        "coulomb_friction": 0.1,
        "residual_ratio": 3.0,
        "sample_period": 1e-3,
        "noise": "white/hum",
        "linear": False,
    }


def named(*names, verdict="explained", **quantities):
    return Outcome(verdict, dict.fromkeys(names, quantities), (5.0, 1.0), (0.5, 0.11, 0.1), 2.002)


def test_a_case_is_the_same_however_many_are_drawn():
    counts = dict.fromkeys(GROUPS, 3)
    few, more = draw(7, counts, 6.0), draw(7, dict.fromkeys(GROUPS, 30), 6.0)
    by_name = {case.name: case for case in more}
    assert [case == by_name[case.name] for case in few] == [True] * len(few)
    assert len({case.number for case in more}) == len(more)
    assert one(8, "single", 0, 6.0) != one(7, "single", 0, 6.0)


def test_every_effect_is_drawn_at_every_strength():
    drawn = [case.hidden for case in draw(1, {"single": 63}, 6.0)]
    assert [case.effects[0].name for case in drawn] == [*CATALOGUE] * 3
    assert all(0.15 <= case.severity <= 0.3 for case in drawn[:21])
    assert all(0.5 <= case.severity <= 0.8 for case in drawn[42:])
    assert {case.axis.linear for case in drawn} == {True, False}
    assert {case.sensors.sample_period for case in drawn} == {0.5e-3, 1e-3, 2e-3, 4e-3}


@pytest.mark.parametrize(
    ("hidden", "said", "right"),
    [
        (truth("unbalance"), named("unbalance"), True),
        (truth("unbalance"), named("unbalance", "cogging_torque"), False),
        (truth("torque_offset", torque=0.03), named("direction_dependent_friction"), True),
        (truth("unbalance"), named(verdict="nothing_missing"), False),
        (truth(group="null"), named(verdict="nothing_missing"), True),
        (truth(group="null"), named("unbalance"), False),
        (truth("vibration", group="outside"), named(verdict="unexplained_remainder"), True),
        (truth("vibration", group="outside"), named(verdict="nothing_missing"), False),
        (truth("unbalance"), Outcome(refused="too short"), False),
    ],
)
def test_judgement(hidden, said, right):
    assert score("case", hidden, said).right == right


def test_without_its_name_only_a_remainder_is_right():
    left = score("case", truth("unbalance"), named(verdict="unexplained_remainder"), without_truth=True)
    other = score("case", truth("unbalance"), named("cogging_torque"), without_truth=True)
    assert left.right
    assert not other.right
    assert false_names(other) == ["cogging_torque"]


def test_share_of_the_gap_above_the_floor():
    found = score("case", truth("unbalance"), named("unbalance"))
    assert found.closed == pytest.approx((0.5 - 0.11) / (0.5 - 0.1))
    assert found.inertia_error == pytest.approx(1e-3)


def test_true_values_in_the_diagnosis_quantities():
    friction = truth("direction_dependent_friction", coulomb_difference=0.04, viscous_share=0.5)
    both = expected(friction, "direction_dependent_friction", "direction_dependent_friction")
    # relative difference of either side 0.5*0.04/(2*0.1), of K_w = 0.01, twice
    assert both == pytest.approx({"coulomb_difference": 0.04, "viscous_difference": 0.002})
    assert expected(friction, "direction_dependent_friction", "torque_offset") == pytest.approx({"torque": 0.02})
    offset = truth("torque_offset", torque=0.03)
    assert expected(offset, "torque_offset", "direction_dependent_friction")["coulomb_difference"] == 0.06


def test_intervals_hold_angles_a_turn_away_and_whole_numbers():
    cogging = truth("cogging_torque", amplitude=0.1, harmonic=6.0, phase=3.1)
    turned = 3.1 - 2.0 * np.pi
    reported = {
        "amplitude": (0.12, 0.11, 0.13),
        "harmonic": (6.0, 6.0, 6.0),
        "phase": (turned, turned - 0.01, turned + 0.01),
    }
    found = compared(cogging, "cogging_torque", "cogging_torque", reported)
    assert found["amplitude"].half_widths == pytest.approx(2.0)
    assert found["amplitude"].error == pytest.approx(0.2)
    assert found["phase"].error == pytest.approx(0.0, abs=1e-12)
    assert {key: one.inside for key, one in found.items()} == {"amplitude": False, "harmonic": True, "phase": True}


def test_confusion_counts_each_name_and_what_was_said_instead():
    scores = [
        score("a", truth("unbalance"), named("unbalance")),
        score("b", truth("unbalance"), named(verdict="unexplained_remainder")),
        score("c", truth(group="null"), named(verdict="nothing_missing")),
    ]
    rows, matrix, cases = counted(scores)
    assert rows == ["unbalance", "nothing hidden"]
    assert cases.tolist() == [2, 1]
    assert matrix.sum() == 3
    assert given(scores[1]) == [REMAINDER]
    assert "single effects named exactly | 1/2" in markdown(scores, "title", "command")
    assert len(cases_csv(scores).splitlines()) == 4
