"""Realistic axes: compatible effects, a draw that repeats, and judgement."""

import pytest

from bench.validation.independent.effects import CATALOGUE
from tests.studies.nuisance.answer import Answer
from tests.studies.nuisance.realistic import MANY, SEVERITY, cases_csv, draw, judged, markdown, one, severities_of


def test_four_to_six_effects_that_an_axis_can_have_together():
    drawn = draw(1, 30)
    names = [{effect.name for effect in case.hidden.effects} for case in drawn]
    assert {len(those) for those in names} == set(range(MANY[0], MANY[1] + 1))
    assert not any(CATALOGUE[name].excludes in those for those in names for name in those)
    assert all(SEVERITY[0] <= s <= SEVERITY[1] for place in range(30) for s in severities_of(1, place, 6))


def test_a_case_is_the_same_however_many_are_drawn():
    few, again = draw(3, 2)[1].hidden, one(3, 1).hidden
    assert (few.axis, few.effects, few.sensors) == (again.axis, again.effects, again.sensors)
    assert few.axis != one(4, 1).hidden.axis


def test_judgement_takes_twins_as_one():
    truth = {"effects": ["unbalance", "torque_offset", "backlash"], "inertia": 1.0}
    said = Answer(
        0,
        verdict="explained",
        named=("unbalance", "direction_dependent_friction", "friction_warmup"),
        inertia=(1.02, 1.01, 1.03),
    )
    score = judged("case", truth, (0.2, 0.3, 0.4), said)
    assert score.missed == ("backlash",)
    assert score.false == ("friction_warmup",)
    assert score.half_widths == pytest.approx(2.0)
    text = markdown([score], "command")
    assert "| effects named | 2 of 3, 66.7 % | 90 % |" in text
    assert "| J within its 95 % interval | 0 of 1 | 90 % |" in text
    assert len(cases_csv([score]).splitlines()) == 2


def test_no_diagnosis_names_nothing():
    score = judged("case", {"effects": ["unbalance"], "inertia": 1.0}, (0.2,), Answer(1, said="too short"))
    assert score.missed == ("unbalance",)
    assert "| no diagnosis | 1 of 1 |  |" in markdown([score], "command")
