"""A small sample of corrupted recordings, with a floor: none that a check can see is wrong without a word."""

import pytest

from tests.studies.corrupt import signals
from tests.studies.corrupt.__main__ import KINDS, outcome

#: Of each way in which one can be noticed: by sign, drop-out, range, delay, scale, time and damage to the file.
SAMPLE = (
    "sign of the current turned for a third",
    "current zero for a tenth",
    "current clipped at 40 %",
    "current 20 ms early",
    "mA from half on",
    "time twice as long",
    "parquet: one bit flipped",
    "csv: fifty digits changed",
)


@pytest.mark.parametrize("kind", SAMPLE)
def test_none_is_wrong_without_a_word(tmp_path, kind):
    assert [what for number in range(2) if (what := outcome(kind, number, tmp_path)[0]) == "wrong"] == []


def test_what_is_sound_is_not_refused(tmp_path):
    assert [outcome("nothing", number, tmp_path) for number in range(4)] == [("right", "")] * 4


def test_there_are_kinds_enough_and_those_that_nobody_can_see_are_named():
    assert len(KINDS) > 60 and set(KINDS) > signals.OF_ANOTHER_AXIS
