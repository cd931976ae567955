"""Recordings with a student's mistake, through every task: no wrong number is said to be done, and why is shown.

Mistakes and their strengths are drawn at random; the truth is that of the simulated axis, which the folder lacks.
"""

import json
import shutil

import numpy as np
import pytest

from bench.assets import asset
from tests.course import mistakes
from tests.course.mistakes import (
    BARE,
    BEYOND_MENDING,
    FASTEST,
    MISTAKES,
    Folder,
    recorded_in,
    tasks_of,
    wrong_numbers,
)

TRACES = asset("data", "traces")
COUNT = 20
#: Every mistake once, and more that are drawn; slow are those too that are another one the other way round.
DRAWN = np.random.default_rng(25).choice(list(MISTAKES), COUNT)
REVERSE = [mistakes.radians_as_degrees, mistakes.turns_as_radians, mistakes.ms_as_seconds]
REVERSE += [mistakes.amperes_as_milliamperes, mistakes.one_sample_at_zero]
CASES = [(mistake, 0) for mistake in BEYOND_MENDING | MISTAKES if mistake not in REVERSE]
MORE = [(mistake, 0) for mistake in REVERSE] + [(mistake, 1) for mistake in BEYOND_MENDING]
MORE += [(mistake, seed) for seed, mistake in enumerate(DRAWN, 1)]
CASES += [pytest.param(*case, marks=pytest.mark.slow) for case in MORE]


@pytest.fixture(scope="module")
def recorded():
    return recorded_in(TRACES)


@pytest.fixture(scope="module")
def truth():
    """True values by task and name, in the report's units."""
    axis = json.loads((TRACES / "MaxAcc.trace.truth.json").read_text())["parameters"]
    throw = json.loads((TRACES / "catapult" / "truth.json").read_text())["parameters"]
    known = {("1", name): throw[name]["value"] for name in "abc"}
    for task in "69":
        known |= {(task, "J"): 22.5, (task, "J_load"): 22.25}
    known |= {("9", "K_fric_w"): 1.1e-3, ("9", "K_fric_0"): 0.085}
    return known | {("10", "measured corner"): axis["corner_speed"]["value"] * 30.0 / np.pi}


@pytest.mark.parametrize(("mistake", "seed"), CASES, ids=lambda value: getattr(value, "__name__", str(value)))
def test_no_wrong_number_is_done(mistake, seed, recorded, truth, tmp_path):
    of = Folder(dict(recorded[0]), list(recorded[1]))
    mistake(of, np.random.default_rng(seed))
    of.write(tmp_path / "data")
    tasks = tasks_of(tmp_path / "data")
    assert wrong_numbers(tasks, truth) == {}
    reasons = [task["reason"] for task in tasks if task["status"] == "not_done"]
    assert reasons
    assert any((MISTAKES | BEYOND_MENDING)[mistake] in reason for reason in reasons), reasons


@pytest.mark.parametrize(
    ("pair", "seed"),
    [
        ((mistakes.the_same_file_twice, mistakes.scale_of_the_current), 1),
        ((mistakes.hole, mistakes.milliamperes_as_amperes), 1),
        ((mistakes.late, mistakes.columns_swapped), 1),
        pytest.param((mistakes.columns_swapped, mistakes.amperes_as_milliamperes), 1, marks=pytest.mark.slow),
        ((mistakes.files_swapped, mistakes.two_at_once), 1),
        pytest.param((mistakes.the_same_file_twice, mistakes.peak_for_rms), 2, marks=pytest.mark.slow),
        pytest.param((mistakes.two_at_once, mistakes.sign), 1, marks=pytest.mark.slow),
    ],
    ids=lambda value: " and ".join(one.__name__ for one in value) if isinstance(value, tuple) else "",
)
def test_two_mistakes_are_both_named(pair, seed, recorded, truth, tmp_path):
    """One in what the other hides: a file that stands twice, a hole, exchanged columns, exchanged files."""
    of, random = Folder(dict(recorded[0]), list(recorded[1])), np.random.default_rng(seed)
    for mistake in pair:
        mistake(of, random)
    of.write(tmp_path / "data")
    tasks = tasks_of(tmp_path / "data")
    assert wrong_numbers(tasks, truth) == {}
    reasons = " ".join(task["reason"] for task in tasks if task["status"] == "not_done")
    assert [mistake.__name__ for mistake in pair if MISTAKES[mistake] not in reasons] == [], reasons


def test_what_is_right_is_done_in_the_courses_words(recorded, truth, tmp_path):
    """Speeds of a resolution of 0.02 rad/s, and a current of 10 mA, as drives have them, are fine enough."""
    of = Folder(dict(recorded[0]), list(recorded[1]))
    of.tables = {name: np.round(rows / [1e-3, 0.02, 0.01]) * [1e-3, 0.02, 0.01] for name, rows in of.tables.items()}
    of.scale((BARE, FASTEST), 1.0, 30.0 / np.pi, 1.0)
    of.heads |= {BARE: "t / s;n / (1/min);Iq / A", FASTEST: "Zeit in s;Drehzahl in U/min;Strom in A"}
    of.write(tmp_path / "data")
    shutil.copy(tmp_path / "data" / "MaxAcc.csv", tmp_path / "data" / "MaxAcc_2.csv")
    tasks = tasks_of(tmp_path / "data")
    assert [task["reason"] for task in tasks if task["status"] == "not_done"] == []
    assert wrong_numbers(tasks, truth) == {}
    (run_up,) = [task for task in tasks if task["key"] == "10"]
    assert "MaxAcc_2.csv passed over, as MaxAcc.csv has the name of the course." in run_up["says"]
