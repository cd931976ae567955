"""Over a fleet: who is compared with what, how often nothing is taken for a change, and what calls for a person."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from scipy import stats

from bench.bounds import bounds
from bench.fleet.change_point import change_point
from bench.fleet.evaluate import Job, PlannedRecording
from bench.fleet.manifest import Manifest
from bench.fleet.summary import summarise
from tests.fit.motions import NAMES, RIG

JOB = Job("", "", RIG, False, bounds())


def looked_over(values, times=None, rigs=None, errors=None, results=None):
    """Summary of axes (a,) that are recorded n times each, all quantities from values (a, n)."""
    count, each = values.shape
    times = np.tile(np.arange(each, dtype=float), count) if times is None else times
    axes = [f"axis {axis}" for axis in range(count) for _ in range(each)]
    files = [f"{row}.csv" for row in range(count * each)]
    table = pa.table({"file": files, "rig": ["rig.toml"] * len(files), "axis": axes, "time": times})
    rigs = ["same"] * len(files) if rigs is None else rigs
    planned = [PlannedRecording(str(row), JOB, None, {"rig_sha256": rig}) for row, rig in enumerate(rigs)]
    errors = np.full(values.size, 1e-3) if errors is None else errors
    usual = [found(value, error) for value, error in zip(values.ravel(), errors, strict=True)]
    return summarise(Manifest(Path("fleet.csv"), table), planned, results or usual)


def found(value, error, **more):
    around = [float(value - 1.96 * error), float(value + 1.96 * error)]
    parameter = {"value": float(value), "unit": "kg*m**2", "std_error": float(error), "ci95": around}
    result = {"status": "done", "reason": None, "parameters": {NAMES[0]: parameter}, "explained": 0.99, "checks": []}
    return result | more


def test_of_fleets_in_which_nothing_changes_at_most_one_in_a_hundred_names_an_axis():
    rng, fleets = np.random.default_rng(5), 100
    alarms = sum(bool(looked_over(rng.normal(1.0, 0.02, (20, 8))).changed) for _ in range(fleets))
    assert alarms <= stats.binom.ppf(0.999, fleets, 0.01)


def stepped(step, place=6, count=1):
    """Values (count, 12) of axes whose first rises."""
    values = np.random.default_rng(1).normal(1.0, 0.01, (count, 12))
    values[0, place:] += step
    return values


def test_axes_that_change_are_found_among_those_that_do_not():
    values = stepped(0.15, count=40)
    values[17, 6:] += 0.15
    summary = looked_over(values)
    assert {(one.history.axis, one.since, one.counts) for one in summary.changed} == {
        ("axis 0", "6", (6, 6)),
        ("axis 17", "6", (6, 6)),
    }
    assert summary.compared == 40


def test_recordings_are_compared_in_the_order_of_time_whatever_the_manifests_is():
    values = np.random.default_rng(1).normal(1.0, 0.01, (1, 12))
    values[0, ::2] += 0.3
    times = np.array([100.0 + k if k % 2 == 0 else float(k) for k in range(12)])
    assert not looked_over(values).changed
    (changed,) = looked_over(values, times).changed
    assert (changed.since, changed.file, changed.step.place) == ("100", "0.csv", 6)


def test_what_has_no_time_or_another_rig_is_not_compared():
    assert looked_over(stepped(0.3)).changed
    assert not looked_over(stepped(0.3), rigs=["one"] * 6 + ["other"] * 6).changed
    assert looked_over(stepped(0.3), np.full(12, np.nan)).compared == 0


@pytest.mark.parametrize(("factor", "compared"), [(4.99, True), (5.01, False), (1000.0, False)])
def test_a_recording_counts_up_to_five_times_the_median_error(factor, compared):
    """One that says little neither alarms, however far it is off, nor hides what others say."""
    errors, values = np.where(np.arange(12) == 11, factor, 1.0) * 1e-3, stepped(0.15)
    (changed,) = looked_over(values, errors=errors).changed
    assert sum(changed.counts) == changed.history.values.size == 11 + compared
    alone = stepped(2.0, place=11)
    assert compared or not looked_over(alone, errors=errors).changed


def test_an_alarm_is_held_against_one_in_a_hundred_of_all_axes_together():
    """Of axes that are alike the chance of each is its own times how many there are that are no surer."""
    step = np.array([1.0, 1.1, 0.9, 1.0, 1.05, 0.95, 1.4, 1.35, 1.45])
    still = np.tile([1.0, 1.1, 0.9], 3)
    alone = change_point(step, np.full(9, 1e-3)).chance
    (changed,) = looked_over(np.array([step, *[still] * 9])).changed
    assert changed.chance == pytest.approx(10.0 * alone)
    both = looked_over(np.array([step, step, *[still] * 8])).changed
    assert [one.chance for one in both] == pytest.approx([10.0 * alone] * 2)
    assert not looked_over(np.array([step, *[still] * round(0.0101 / alone)])).changed
    assert looked_over(np.array([step, *[still] * (round(0.0099 / alone) - 1)])).changed


def test_what_was_not_done_or_has_no_error_is_not_compared():
    results = [found(value, 1e-3) for value in stepped(0.3)[0]]
    for place, other in ((3, {"status": "refused", "reason": "no"}), (8, {"status": "done"})):
        results[place] = {**results[place], **other}
    results[9]["parameters"][NAMES[0]]["std_error"] = None
    (changed,) = looked_over(stepped(0.3), results=results).changed
    assert changed.history.rows == (0, 1, 2, 4, 5, 6, 7, 8, 10, 11)
    assert changed.counts == (5, 5)


@pytest.mark.parametrize(
    ("more", "kind", "reason"),
    [
        ({"status": "refused", "reason": "too short"}, "refused", "too short"),
        ({"explained": 0.5}, "unexplained", "inertia and friction explain only 50 % of the effort"),
        ({"verdict": "unexplained_remainder", "effects": []}, "unexplained", "no effect of the catalogue"),
        ({"checks": [{"name": "lost_samples", "found": "7"}]}, "checks", "lost_samples: 7"),
    ],
)
def test_a_person_is_called_for(more, kind, reason):
    results = [found(1.0, 0.1), found(1.0, 0.1, **more), found(1.0, 0.1)]
    (concern,) = looked_over(np.ones((1, 3)), results=results).concerns
    assert (concern.kind, concern.recordings, concern.of, concern.file) == (kind, 1, 3, "1.csv")
    assert reason in concern.reason


def test_nobody_is_called_for_what_is_explained():
    explained = {"explained": 0.5, "verdict": "explained", "effects": [{"name": "an_effect"}]}
    summary = looked_over(np.ones((1, 2)), results=[found(1.0, 0.1), found(1.0, 0.1, **explained)])
    assert not summary.concerns
    assert [(one.name, one.recordings, one.of, one.since) for one in summary.shown] == [("an_effect", 1, 1, "1")]
