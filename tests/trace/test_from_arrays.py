"""Samples in memory take the way of samples in a file: the same trace comes out, the same faults are refused."""

import pickle
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest

from bench.errors import InputError
from bench.trace.read import read
from bench.trace.trace import Trace
from tests.trace.recordings import csv_text, current, velocity

UNITS = {"time": "s", "velocity": "deg/s", "current": "mA"}
RNG = np.random.default_rng(5)
REGULAR = np.arange(2000) * 1e-3


class Frame:
    """A data frame of another library: nothing of it is known but Arrow's protocol."""

    def __init__(self, columns):
        self._table = pa.table(columns)

    def __arrow_c_stream__(self, requested_schema=None):
        return self._table.__arrow_c_stream__(requested_schema)


def columns(time=REGULAR):
    return {"time": time, "velocity": velocity(time), "current": current(time)}


def assert_same(trace, other):
    np.testing.assert_array_equal(trace.time, other.time)
    assert dict(trace.units) == dict(other.units)
    for name, values in other.signals.items():
        np.testing.assert_array_equal(trace[name], values)


@pytest.mark.parametrize(
    "time",
    [
        REGULAR,
        np.delete(REGULAR, [700, 701]),
        np.delete(REGULAR, slice(900, 1100)),
        np.sort(REGULAR + RNG.uniform(-2e-4, 2e-4, REGULAR.size)),
        np.insert(REGULAR, 500, REGULAR[500]),
    ],
    ids=["regular", "missing samples", "hole", "jitter", "duplicate"],
)
def test_arrays_give_the_trace_that_a_file_of_them_gives(tmp_path, time):
    table = columns(time)
    path = tmp_path / "run.csv"
    path.write_text(csv_text(time, velocity__deg_s=table["velocity"], current__mA=table["current"]), encoding="utf-8")
    from_file = read(path)
    from_arrays = Trace.from_arrays(table, UNITS)
    assert_same(from_arrays, from_file)
    assert from_arrays.time_base == from_file.time_base
    assert from_arrays.notes == from_file.notes


@pytest.mark.parametrize("frame", [pa.table, Frame], ids=["Arrow", "another library's"])
def test_a_data_frame_gives_what_its_arrays_give(frame):
    assert_same(Trace.from_arrays(frame(columns()), UNITS), Trace.from_arrays(columns(), UNITS))


@pytest.mark.parametrize("period", [1e-3, "1 ms"])
def test_a_sample_period_stands_for_regular_times(period):
    signals, units = ({name: of[name] for name in ("velocity", "current")} for of in (columns(), UNITS))
    assert_same(Trace.from_arrays(signals, units, sample_period=period), Trace.from_arrays(columns(), UNITS))


def test_a_name_may_carry_its_unit_and_a_rigs_columns_name_foreign_ones():
    table = columns()
    named = {"time [s]": table["time"], "Axis1.Vel": -table["velocity"], "current [mA]": table["current"]}
    trace = Trace.from_arrays(named, columns={"velocity": "-Axis1.Vel [deg/s]"})
    assert_same(trace, Trace.from_arrays(table, UNITS))


def test_moments_are_times_from_the_first():
    moments = np.datetime64("2026-03-01T12:00:00", "ns") + (1e9 * REGULAR).round().astype("timedelta64[ns]")
    trace = Trace.from_arrays({**columns(), "time": moments}, {"velocity": "deg/s", "current": "mA"})
    np.testing.assert_allclose(trace.time, REGULAR, atol=1e-12)


def test_what_is_not_needed_stops_nothing():
    extra = {"comment": ["ok"] * 2000, "matrix": np.zeros((2000, 3)), "speed": REGULAR, "ragged": [[1], [1, 2]]}
    trace = Trace.from_arrays({**columns(), **extra}, UNITS)
    assert set(trace.signals) == {"velocity", "current"}
    assert trace.metadata["dropped_columns"] == "comment, matrix, speed, ragged"


def test_the_trace_has_samples_of_its_own():
    table = columns(REGULAR.copy())
    trace = Trace.from_arrays(table, UNITS)
    for values in table.values():
        values[:] = 0.0
    assert_same(trace, Trace.from_arrays(columns(), UNITS))


@pytest.mark.parametrize(
    ("changed", "units", "arguments", "words"),
    [
        ({}, {"time": "s", "current": "mA"}, {}, ["velocity", "no unit", 'units={"velocity": "rad/s"}']),
        ({}, {**UNITS, "velocty": "deg/s"}, {}, ["velocty", "did you mean 'velocity'"]),
        ({"current": current(REGULAR)[:-1]}, UNITS, {}, ["current", "1999", "2000"]),
        ({"velocity": np.zeros((2000, 2))}, UNITS, {}, ["velocity", "(2000, 2)"]),
        ({"velocity": ["fast"] * 2000}, UNITS, {}, ["velocity", "string"]),
        ({"velocity": [1 + 1j] * 2000}, UNITS, {}, ["velocity", "number"]),
        ({"velocity": [[1.0], [1.0, 2.0]]}, UNITS, {}, ["velocity", "number"]),
        ({"velocity": [*velocity(REGULAR[1:]), np.inf]}, UNITS, {}, ["velocity", "sample 1999", "inf"]),
        ({"velocity": [None] * 2000}, UNITS, {}, ["velocity", "null"]),
        ({"time": np.where(REGULAR == 0.8, 3e-4, REGULAR)}, UNITS, {}, ["time", "backwards"]),
        ({}, UNITS, {"sample_period": 1e-3}, ["time", "sample_period"]),
        ({}, UNITS, {"columns": {"torque": "Axis1.Torque [N*m]"}, "origin": "run 7"}, ["run 7", "Axis1.Torque"]),
    ],
)
def test_a_fault_is_one_line_that_names_the_signal(changed, units, arguments, words):
    with pytest.raises(InputError) as refused:
        Trace.from_arrays({**columns(), **changed}, units, **arguments)
    assert "\n" not in str(refused.value)
    assert [word for word in words if word not in str(refused.value)] == []


@pytest.mark.parametrize("period", [0.0, -1e-3, np.nan, np.inf, "1 m", "fast"])
def test_a_sample_period_is_a_positive_time(period):
    with pytest.raises(InputError, match="arrays: sample_period: found"):
        Trace.from_arrays({"velocity [rad/s]": REGULAR}, sample_period=period)


def test_what_has_no_time_or_no_columns_is_refused():
    with pytest.raises(InputError, match="arrays: time: found no column of it and no sample_period"):
        Trace.from_arrays({"velocity [rad/s]": REGULAR})
    with pytest.raises(InputError, match="arrays: found ndarray; allowed: arrays by their names, or a data frame"):
        Trace.from_arrays(REGULAR, sample_period=1e-3)


@pytest.mark.parametrize("nothing", [None, np.nan])
def test_a_few_values_that_are_none_are_holes(nothing):
    speed = velocity(REGULAR).tolist()
    speed[700] = nothing
    trace = Trace.from_arrays({**columns(), "velocity": speed}, UNITS)
    assert len(trace) == 1999 and len(trace.segments) == 2
    assert any("1 cell is empty or no number, the first at arrays: sample 700" in note for note in trace.notes)


def test_a_trace_travels_to_another_process():
    """All of it, and read-only again."""
    trace = replace(Trace.from_arrays(columns(), UNITS), metadata={"drive": "x"}, notes=("y",), continues=True)
    copy = pickle.loads(pickle.dumps(trace))
    assert_same(copy, trace)
    for name in ("metadata", "origin", "notes", "continues", "wraps"):
        assert getattr(copy, name) == getattr(trace, name)
    with pytest.raises(TypeError):
        copy.signals["velocity"] = np.zeros(3)
