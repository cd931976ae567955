"""Recordings with a student's mistake, through every task: no wrong number is said to be done, and why is shown.

Mistakes and their strengths are drawn at random; the truth is that of the simulated axis, which the folder lacks.
"""

import json
import shutil

import numpy as np
import pytest

from bench.assets import asset
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
WORDS = {mistake.__name__: words for mistake, words in (BEYOND_MENDING | MISTAKES).items()}
NAMED = {mistake.__name__: mistake for mistake in BEYOND_MENDING | MISTAKES}
#: What is another mistake the other way round, and is tried in the slow runs alone, as are draws of other strengths.
REVERSE = ("radians_as_degrees", "turns_as_radians", "ms_as_seconds", "amperes_as_milliamperes", "one_sample_at_zero")
DRAWN = np.random.default_rng(25).choice([mistake.__name__ for mistake in MISTAKES], 20)
SLOW = [((name,), 0) for name in REVERSE] + [((mistake.__name__,), 1) for mistake in BEYOND_MENDING]
SLOW += [((str(name),), seed) for seed, name in enumerate(DRAWN, 1)]
SLOW += [(("columns_swapped", "amperes_as_milliamperes"), 1), (("the_same_file_twice", "peak_for_rms"), 2)]
SLOW += [(("two_at_once", "sign"), 1)]
#: One alone, and one in what another hides: a file that stands twice, a hole, exchanged columns, exchanged files.
CASES = [((name,), 0) for name in NAMED if name not in REVERSE]
CASES += [(("the_same_file_twice", "scale_of_the_current"), 1), (("hole", "milliamperes_as_amperes"), 1)]
CASES += [(("late", "columns_swapped"), 1), (("files_swapped", "two_at_once"), 1)]
CASES += [pytest.param(*case, marks=pytest.mark.slow) for case in SLOW]


@pytest.fixture(scope="module")
def recorded():
    return recorded_in(TRACES)


@pytest.fixture(scope="module")
def truth():
    """True values by task and name, in the report's units."""
    axis = json.loads((TRACES / "MaxAcc.trace.truth.json").read_text())["parameters"]
    throw = json.loads((TRACES / "catapult" / "truth.json").read_text())["parameters"]
    known = {("1", name): throw[name]["value"] for name in "abc"}
    known |= {(task, name): value for task in "69" for name, value in (("J", 22.5), ("J_load", 22.25))}
    known |= {("9", "K_fric_w"): 1.1e-3, ("9", "K_fric_0"): 0.085}
    return known | {("10", "measured corner"): axis["corner_speed"]["value"] * 30.0 / np.pi}


@pytest.mark.parametrize(("names", "seed"), CASES, ids=lambda one: "+".join(one) if isinstance(one, tuple) else "")
def test_no_wrong_number_is_done_and_each_mistake_is_named(names, seed, recorded, truth, tmp_path):
    of, random = Folder(dict(recorded[0]), list(recorded[1])), np.random.default_rng(seed)
    for name in names:
        NAMED[name](of, random)
    of.write(tmp_path / "data")
    tasks = tasks_of(tmp_path / "data")
    assert wrong_numbers(tasks, truth) == {}
    reasons = [task["reason"] for task in tasks if task["status"] == "not_done"]
    assert [name for name in names if not any(WORDS[name] in reason for reason in reasons)] == [], reasons


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
