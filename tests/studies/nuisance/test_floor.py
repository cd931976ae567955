"""A small nuisance set that must not get worse: of each kind of damage some that are answered or refused rightly."""

import pytest

from tests.studies.nuisance.draw import draw
from tests.studies.nuisance.run import scored
from tests.studies.nuisance.score import RIGHT, WRONG
from tests.studies.nuisance.table import not_right

#: A current early, of another axis or a speed of another scale are the gate's own tests.
CASES = (*("position-wrapped-0-0", "differenced-speed-1-0", "current-late-0-1", "current-sign-0-1", "hum-1-0"),)


@pytest.fixture(scope="module")
def scores(tmp_path_factory):
    drawn = [case for case in draw(1, 2) if case.name in CASES]
    found = scored(tmp_path_factory.mktemp("nuisance"), drawn, jobs=1, show=False)
    print(f"\n{not_right(found)}")  # pytest -s
    return found


def test_nothing_is_wrong_or_ends_in_a_fault(scores):
    assert len(scores) == len(CASES)
    assert [score.case.name for score in scores if score.judgement == WRONG or score.fault] == []


def test_nearly_all_is_right(scores):
    assert sum(score.judgement == RIGHT for score in scores) >= len(CASES) - 1
