"""A small blind set that must not get worse: every effect once, nothing hidden, and physics outside the catalogue."""

import pytest

from bench.validation.independent.effects import CATALOGUE
from tests.outside import OUTSIDE
from tests.studies.blind.__main__ import scored
from tests.studies.blind.draw import STRENGTHS, one
from tests.studies.blind.table import false_names, headline, wrong

pytestmark = pytest.mark.slow

SEED, SECONDS, CONTROL_PERIOD = 2, 5.0, 250e-6
#: Singles are drawn in rounds over the catalogue, one strength after the other: this is the middle one.
MIDDLE = len(CATALOGUE) * list(STRENGTHS).index("middle")


@pytest.fixture(scope="module")
def scores(tmp_path_factory):
    places = {"single": range(MIDDLE, MIDDLE + len(CATALOGUE)), "null": range(4), "outside": range(len(OUTSIDE))}
    drawn = [one(SEED, group, place, SECONDS, CONTROL_PERIOD) for group, those in places.items() for place in those]
    found = scored(tmp_path_factory.mktemp("blind"), drawn, SEED, jobs=2, show=False)
    print(f"\n{headline(found)}\n\n{wrong(found)}")  # what the floor is set by: pytest -s
    return found


def test_each_effect_is_named(scores):
    singles = [score for score in scores if score.group == "single"]
    assert {score.hidden for score in singles} == set(CATALOGUE)
    assert sum(score.right for score in singles) >= 20


def test_nothing_hidden_is_not_named(scores):
    assert [score.name for score in scores if score.group == "null" and score.outcome.named] == []


def test_hardly_anything_carries_a_name_that_is_not_hidden(scores):
    assert len([score.name for score in scores if false_names(score)]) <= 1


def test_physics_outside_the_catalogue_is_left_a_remainder(scores):
    assert sum(score.right for score in scores if score.group == "outside") >= len(OUTSIDE) - 1


def test_what_is_found_closes_the_gap_and_leaves_inertia_right(scores):
    singles = [score for score in scores if score.group == "single" and score.right]
    closed = sorted(score.closed for score in singles if score.closed is not None)
    errors = sorted(abs(score.inertia_error) for score in singles)
    assert closed[len(closed) // 2] > 0.95
    assert errors[len(errors) // 2] < 5e-4
