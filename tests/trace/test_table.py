"""How columns of a table become signals: by a rig, by well-known names, by what the file itself says of units."""

import gzip

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bench.errors import InputError
from bench.trace.read import read, read_recording
from tests.trace.recordings import csv_text, shared, velocity

TIME = np.arange(500) * 1e-3


def test_content_decides_before_the_ending(tmp_path):
    packed, parquet = tmp_path / "run.mat", tmp_path / "run.csv"
    packed.write_bytes(gzip.compress(csv_text(TIME, velocity__rad_s=velocity(TIME)).encode()))
    pq.write_table(pa.table({"time [s]": TIME, "velocity [rad/s]": velocity(TIME)}), parquet)
    assert [read_recording(path).format for path in (packed, parquet)] == ["CSV table", "Parquet"]
    assert np.array_equal(read(packed)["velocity"], read(parquet)["velocity"])


def test_parquet_unit_in_the_field_metadata(tmp_path):
    kinds = {"time": (pa.int64(), "us"), "velocity": (pa.float32(), "deg/s")}
    schema = pa.schema([pa.field(name, kind, metadata={"unit": unit}) for name, (kind, unit) in kinds.items()])
    speed = velocity(TIME).astype(np.float32)
    pq.write_table(pa.table([(TIME * 1e6).round().astype(np.int64), speed], schema=schema), tmp_path / "run.parquet")
    trace = read(tmp_path / "run.parquet")
    np.testing.assert_allclose(trace.time, TIME, atol=1e-15)
    np.testing.assert_allclose(trace["velocity"], np.deg2rad(speed.astype(float)), rtol=1e-15)


def test_parquet_moments_are_times_from_the_first_and_one_that_is_not_known_is_no_number(tmp_path):
    moments = [1_700_000_000_000_000 + 1000 * k for k in range(500)]
    for unknown in (None, 1):
        times = pa.array([None if k == unknown else one for k, one in enumerate(moments)], pa.timestamp("us"))
        pq.write_table(pa.table({"time": times, "velocity [rad/s]": velocity(TIME)}), tmp_path / "run.parquet")
        expected = 1e6 * np.where(np.arange(500) == (-1 if unknown is None else unknown), np.nan, TIME)
        np.testing.assert_allclose(read_recording(tmp_path / "run.parquet").channels[0].values, expected)
    assert read(tmp_path / "run.parquet").time[2] == pytest.approx(2e-3)


#: What three samples are called and how they are written, the columns of a rig, signals in SI, and words of a note.
COLUMNS = {
    "decimal commas": ("time [ms];velocity [rad/s]", "{0},0;+{1},5", {}, {"velocity": [1.5, 2.5, 3.5]}, ""),
    "names, units, signs": (
        "T,Axis1.ActVel,Axis1.Trq [%]",
        "{0},{1},{1}0",
        {"time": "T [ms]", "velocity": "-Axis1.ActVel [mm/s]", "torque": "Trq [%]"},
        {"velocity": [-1e-3, -2e-3, -3e-3], "torque": [0.1, 0.2, 0.3]},
        "",
    ),
    "another unit in the rig": (
        "time [ms],velocity [rad/s]",
        "{0},{1}",
        {"velocity": "velocity [deg/s]"},
        {"velocity": np.deg2rad([1, 2, 3])},
        "as in the rig",
    ),
    "a rig for other files": (
        "time [ms],velocity [rad/s]",
        "{0},{1}",
        {"velocity": "Axis1.ActVel [deg/s]"},
        {"velocity": [1, 2, 3]},
        "velocity read from 'velocity [rad/s]', as the file has no 'Axis1.ActVel [deg/s]'",
    ),
    "well-known names": (
        "Time [ms],PLC_PRG.Velocity [rpm],Iq [A],Reference Velocity [rpm],torque [Nm]",
        "{0},60,{1},0,{1}",
        {},
        {"velocity": 2 * np.pi, "current": [1, 2, 3], "velocity_reference": 0.0, "torque": [1, 2, 3]},
        "",
    ),
}


@pytest.mark.parametrize("case", COLUMNS)
def test_columns_become_signals(tmp_path, case):
    head, row, columns, expected, note = COLUMNS[case]
    path = tmp_path / "run.csv"
    path.write_text("\n".join([head, *(row.format(k, k + 1) for k in range(3)), ""]))
    trace = read(path, columns)
    assert set(trace.signals) == set(expected)
    for name, values in expected.items():
        np.testing.assert_allclose(trace[name], np.broadcast_to(values, 3))
    assert any(note in one for one in trace.notes)


def test_laas_recording_reports_its_gaps():
    path = shared("laas_anticogging", "acc_current.txt")
    raw = np.loadtxt(path, delimiter=",", skiprows=1)
    units = {"Time": "s", "Position": "rad", "Velocity": "rad/s", "Iq": "A", "Uq": "V"}
    names = ("time", "position", "velocity", "current", "voltage")
    trace = read(path, {name: f"{key} [{unit}]" for name, (key, unit) in zip(names, units.items(), strict=True)})
    base = trace.time_base
    assert base is not None and base.resampled
    assert len(base.holes) == int((np.diff(raw[:, 0]) > 2.5e-3).sum()) == len(trace.segments) - 1
    assert max(duration for _, duration in base.holes) == pytest.approx(7.1e-3)
    assert trace.sample_period == pytest.approx(1e-3, rel=1e-9)
    assert any("holes" in note for note in trace.notes)
    # between the gaps the interpolated position still follows the recorded one
    np.testing.assert_allclose(trace["position"], np.interp(trace.time, raw[:, 0], raw[:, 1]), atol=0.03)
    bare = read(path)  # without any unit: SI, as position and velocity agree
    assert {name: bare.units[name] for name in ("position", "velocity")} == {"position": "rad", "velocity": "rad/s"}
    np.testing.assert_array_equal(bare["velocity"], trace["velocity"])


def test_laas_compensation_table_is_no_trace():
    with pytest.raises(InputError):
        read(shared("laas_anticogging", "cogging_tableau.txt"))
