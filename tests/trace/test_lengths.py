"""Columns of another length than the time: no reader shortens samples, whatever else a file holds."""

import json

import numpy as np
import pytest
import scipy.io

from bench.errors import InputError
from bench.trace.read import read
from tests.trace import formats

N = 300
TIME = np.arange(N) * 1e-3
SIGNALS = {"time": TIME, "velocity": np.sin(50.0 * TIME), "current": np.cos(50.0 * TIME)}
COLUMNS = {"time": "time [s]", "velocity": "velocity [rad/s]", "current": "current [A]"}


def as_json(path, columns):
    path.write_text(json.dumps({name: np.asarray(values).tolist() for name, values in columns.items()}))


def as_hdf5(path, columns):
    texts = {name: [one.encode() for one in values] for name, values in columns.items() if isinstance(values, list)}
    formats.hdf5(path, {**columns, **texts})


WRITERS = {
    "log.json": as_json,
    "log.npz": lambda path, columns: np.savez(path, **columns),
    "log.mat": scipy.io.savemat,
    "log.h5": as_hdf5,
}


@pytest.mark.parametrize("name", WRITERS)
def test_side_columns_and_a_short_signal_that_nobody_needs_are_left_out_with_a_note(tmp_path, name):
    side = {"joint_names": ["elbow", "wrist"], "gains": np.arange(3.0), "limits": np.arange(N + 5.0)}
    WRITERS[name](tmp_path / name, {**SIGNALS, **side, "temperature": np.array([40.0, 41.0])})
    trace = read(tmp_path / name, {**COLUMNS, "temperature": "temperature [degC]"})
    assert trace.time == pytest.approx(TIME)
    assert set(trace.signals) == {"velocity", "current"}
    assert trace.signals["velocity"] == pytest.approx(SIGNALS["velocity"])
    for left_out in ("gains (3)", "limits (305)", "temperature (2)"):
        assert any(left_out in note for note in trace.notes)


@pytest.mark.parametrize("size", [2, N - 1, N + 1])
@pytest.mark.parametrize("name", WRITERS)
def test_a_signal_of_another_length_is_an_error_that_names_both(tmp_path, name, size):
    current = np.cos(50.0 * np.arange(size) * 1e-3)
    WRITERS[name](tmp_path / name, {**SIGNALS, "current": current})
    with pytest.raises(InputError, match=f"found {size} values; allowed: {N}"):
        read(tmp_path / name, COLUMNS)


def test_names_beside_lists_of_numbers_in_json_name_their_places(tmp_path):
    path = tmp_path / "log.json"
    joints = np.stack([SIGNALS["velocity"], SIGNALS["current"]], axis=1)
    as_json(path, {"time": TIME, "dq": joints, "joint_names": ["elbow", "wrist"]})
    trace = read(path, {"time": "time [s]", "velocity": "dq.wrist [rad/s]"})
    assert trace.signals["velocity"] == pytest.approx(SIGNALS["current"])


def test_a_key_that_begins_in_a_later_sample_of_json_is_kept(tmp_path):
    path = tmp_path / "log.json"
    rows = [{"time": float(time), **({"velocity": float(np.sin(time))} if k else {})} for k, time in enumerate(TIME)]
    path.write_text(json.dumps(rows))
    trace = read(path, {"time": "time [s]", "velocity": "velocity [rad/s]"})
    assert trace.signals["velocity"][-1] == pytest.approx(np.sin(TIME[-1]))


@pytest.mark.parametrize("side", [[1, "a"], [10**400, 1], [{"a": 1}, [2]], [[1], [2, 3]]])
def test_what_arrow_has_no_type_for_stops_no_json(tmp_path, side):
    path = tmp_path / "log.json"
    path.write_text(json.dumps({**{name: values.tolist() for name, values in SIGNALS.items()}, "meta": side}))
    assert read(path, COLUMNS).time.size == N
