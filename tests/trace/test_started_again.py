"""Logs whose clock starts again, whose samples come in another order, or whose columns have no names."""

import numpy as np
import pytest

import bench
from bench.errors import InputError
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording
from bench.trace.read import read_recording
from tests.sines import sines

RATE, INERTIA, COULOMB = 500.0, 0.02, 0.3
WAVES = (2.0, 0.7, 0.0), (0.5, 1.9, 1.0), (0.1, 4.3, 2.0)


@pytest.fixture(scope="module")
def columns():
    """Time, position, speed and torque of an axis whose torque follows from its motion in closed form."""
    time = np.arange(3000) / RATE
    position, speed, acceleration = sines(time, WAVES)
    return np.stack([time, position, speed, INERTIA * acceleration + COULOMB * np.sign(speed)], axis=1)


def written(path, rows, head="t_s,q_rad,v_rad_s,tau_Nm"):
    """A file of rows (n, k), its header before each of several."""
    text = ("\n".join(",".join(f"{one:.9g}" for one in row) for row in part) for part in rows)
    path.write_text("".join(f"{head}\n{part}\n" if head else f"{part}\n" for part in text))
    return path


@pytest.mark.parametrize("parts", [2, 3])
def test_a_log_that_was_started_again_is_as_good_as_its_parts(columns, tmp_path, parts):
    rows = [part - part[0] * [1, 0, 0, 0] for part in np.array_split(columns, parts)]
    trace = bench.read(written(tmp_path / "log.csv", rows))
    found = bench.identify(trace).parameters["moment_of_inertia"]
    assert len(trace.segments) == parts and found.value == pytest.approx(INERTIA, rel=2e-3)
    assert any("start again" in note and "log.csv" in note for note in trace.notes)


def test_samples_in_another_order_are_sorted(columns, tmp_path):
    mixed = columns.copy()
    for k in (40, 700, 2000):
        mixed[[k, k + 1]] = mixed[[k + 1, k]]
    trace = bench.read(written(tmp_path / "log.csv", [mixed]))
    np.testing.assert_allclose(trace["position"], columns[:, 1], atol=1e-8)
    assert any("3 samples" in note and "sorted" in note for note in trace.notes)


def test_a_single_wrong_time_is_refused(columns, tmp_path):
    wrong = columns.copy()
    wrong[400, 0] = 0.0013
    with pytest.raises(InputError, match=r"line 402.*time runs backwards"):
        bench.read(written(tmp_path / "log.csv", [wrong]))


def test_columns_without_names_are_proposed_by_their_motion(columns, tmp_path):
    found = inspect_recording(read_recording(written(tmp_path / "log.csv", [columns], head=None)), GivenOptions())
    signals = [one.suggestion.split(" = ")[0] for one in found.columns]
    assert signals == ["time", "position", "velocity", "torque"]


@pytest.mark.parametrize("head", ["t,q,v,M", "t,pos,vel,eff", "t,q,dq,tau_e"])
def test_letters_are_read_where_motion_agrees(columns, tmp_path, head):
    rows = columns + [0.0, 0.0, 0.0, 0.01] * np.random.default_rng(1).standard_normal(columns.shape)
    found = bench.identify(written(tmp_path / "log.csv", [rows], head)).parameters["moment_of_inertia"]
    assert found.unit == "kg*m**2" and found.value == pytest.approx(INERTIA, rel=2e-3)


def test_a_goal_in_counts_of_a_dynamixel_is_read_as_its_position(tmp_path):
    counts = np.round(2048 + 500 * np.sin(np.arange(500) / 30.0))
    rows = np.stack([np.arange(500.0) * 10.0, counts, np.roll(counts, 2)], axis=1)
    trace = bench.read(written(tmp_path / "log.csv", [rows], "time_ms,goal_position,present_position"))
    np.testing.assert_allclose(trace["position_reference"] * 4096 / (2 * np.pi), counts, atol=1e-6)
