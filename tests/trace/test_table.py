import gzip

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bench.errors import InputError
from bench.trace.read import read, read_recording
from bench.trace.readers.table import find_layout, read_timed
from tests.trace.recordings import csv_text, current, shared, velocity

TIME = np.arange(500) * 1e-3


def test_canonical_csv_is_read_in_si_and_its_values_are_untouched(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text(csv_text(TIME, velocity__deg_s=velocity(TIME), current__mA=current(TIME)))
    trace = read(path)
    assert dict(trace.units) == {"velocity": "rad/s", "current": "A"}
    assert np.array_equal(trace.time, TIME)
    np.testing.assert_allclose(trace["velocity"], np.deg2rad(velocity(TIME)), rtol=1e-15)
    np.testing.assert_allclose(trace["current"], current(TIME) / 1e3, rtol=1e-15)
    assert trace.time_base is not None and not trace.time_base.resampled
    assert trace.notes == ()


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-32"])
def test_unicode_with_a_byte_order_mark_is_read(tmp_path, encoding):
    path = tmp_path / "run.csv"
    path.write_bytes(csv_text(TIME, velocity__deg_s=velocity(TIME)).encode(encoding))
    np.testing.assert_allclose(read(path)["velocity"], np.deg2rad(velocity(TIME)), rtol=1e-15)


def test_content_decides_before_the_ending(tmp_path):
    text = csv_text(TIME, velocity__rad_s=velocity(TIME))
    table = pa.table({"time [s]": TIME, "velocity [rad/s]": velocity(TIME)})
    packed, parquet = tmp_path / "run.mat", tmp_path / "run.csv"
    packed.write_bytes(gzip.compress(text.encode()))
    pq.write_table(table, parquet)
    assert read_recording(packed).format == "CSV table"
    assert read_recording(parquet).format == "Parquet"
    assert np.array_equal(read(packed)["velocity"], read(parquet)["velocity"])


def test_parquet_unit_in_the_field_metadata(tmp_path):
    schema = pa.schema(
        [
            pa.field("time", pa.int64(), metadata={"unit": "us"}),
            pa.field("velocity", pa.float32(), metadata={"unit": "deg/s"}),
        ]
    )
    speed = velocity(TIME).astype(np.float32)
    pq.write_table(pa.table([(TIME * 1e6).round().astype(np.int64), speed], schema=schema), tmp_path / "run.parquet")
    trace = read(tmp_path / "run.parquet")
    np.testing.assert_allclose(trace.time, TIME, atol=1e-15)
    np.testing.assert_allclose(trace["velocity"], np.deg2rad(speed.astype(float)), rtol=1e-15)


def test_a_moment_that_is_not_known_is_no_number(tmp_path):
    moments = pa.array([1_700_000_000_000_000, None, 1_700_000_000_002_000], pa.timestamp("us"))
    pq.write_table(pa.table({"time": moments, "velocity [rad/s]": np.arange(3.0)}), tmp_path / "run.parquet")
    time = read_recording(tmp_path / "run.parquet").channels[0]
    np.testing.assert_array_equal(time.values, [0.0, np.nan, 2000.0])


def test_parquet_moments_are_times_from_the_first(tmp_path):
    moments = pa.array((1_700_000_000_000_000 + np.arange(500) * 1000).tolist(), pa.timestamp("us"))
    pq.write_table(pa.table({"time": moments, "velocity [rad/s]": velocity(TIME)}), tmp_path / "run.parquet")
    np.testing.assert_allclose(read(tmp_path / "run.parquet").time, TIME, atol=1e-15)


def test_semicolons_and_decimal_commas(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time [ms];velocity [rad/s]\n0,0;1,5\n1,0;+2,5\n2,0;-3,25\n")
    assert read(path)["velocity"].tolist() == [1.5, 2.5, -3.25]


def test_columns_map_names_units_and_signs(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("T,Axis1.ActVel,Axis1.Trq [%]\n0,1,10\n1,2,20\n2,3,30\n")
    columns = {"time": "T [ms]", "velocity": "-Axis1.ActVel [mm/s]", "torque": "Trq [%]"}
    trace = read(path, columns)
    np.testing.assert_allclose(trace["velocity"], [-1e-3, -2e-3, -3e-3])
    np.testing.assert_allclose(trace["torque"], [0.1, 0.2, 0.3])
    assert dict(trace.units) == {"velocity": "m/s", "torque": "dimensionless"}


def test_a_unit_the_rig_states_against_the_file_is_reported(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time [ms],velocity [rad/s]\n0,1\n1,2\n2,3\n")
    trace = read(path, {"velocity": "velocity [deg/s]"})
    np.testing.assert_allclose(trace["velocity"], np.deg2rad([1, 2, 3]))
    assert any("as in the rig" in note for note in trace.notes)


def test_a_rig_for_foreign_columns_still_reads_canonical_files(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time [ms],velocity [rad/s]\n0,1\n1,2\n2,3\n")
    trace = read(path, {"velocity": "Axis1.ActVel [deg/s]"})
    assert trace["velocity"].tolist() == [1, 2, 3]
    assert "velocity read from 'velocity [rad/s]', as the file has no 'Axis1.ActVel [deg/s]'" in trace.notes


def test_unknown_columns_are_dropped_by_name_even_when_they_hold_text(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time [ms],velocity [rad/s],state,spare [V]\n0,1,idle,1\n1,2,run,1\n2,3,run,1\n")
    trace = read(path)
    assert trace.metadata["dropped_columns"] == "state, spare [V]"
    assert trace["velocity"].tolist() == [1, 2, 3]


def test_well_known_names(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("Time [ms],PLC_PRG.Velocity [rpm],Iq [A],Reference Velocity [rpm]\n0,60,1,0\n1,60,2,0\n2,60,3,0\n")
    trace = read(path)
    assert set(trace.signals) == {"velocity", "current", "velocity_reference"}
    np.testing.assert_allclose(trace["velocity"], 2 * np.pi)


@pytest.mark.parametrize("unit", ["counts/s", "%", "Nm", "V"])
def test_what_is_no_angle_does_not_pass_for_one(tmp_path, unit):
    path = tmp_path / "run.csv"
    path.write_text(f"time [ms],velocity [{unit}]\n0,1\n1,2\n2,3\n")
    with pytest.raises(
        InputError, match=r"column 'velocity \[.*\]': found unit .*allowed: a unit of the dimension of rad/s"
    ):
        read(path)


def test_newton_metres_as_drives_print_them(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time [ms],velocity [rad/s],torque [Nm]\n0,1,5\n1,2,6\n2,3,7\n")
    assert read(path)["torque"].tolist() == [5, 6, 7]


def test_laas_recording_reports_its_gaps():
    path = shared("laas_anticogging", "acc_current.txt")
    raw = np.loadtxt(path, delimiter=",", skiprows=1)
    gaps = np.diff(raw[:, 0])
    columns = {
        "time": "Time [s]",
        "position": "Position [rad]",
        "velocity": "Velocity [rad/s]",
        "current": "Iq [A]",
        "voltage": "Uq [V]",
    }
    trace = read(path, columns)
    base = trace.time_base
    assert base is not None and base.resampled
    assert len(base.holes) == int((gaps > 2.5e-3).sum()) == len(trace.segments) - 1
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


def test_timed_lines_need_a_column_of_time():
    with pytest.raises(InputError, match=r"x\.log: found columns speed \[rpm\]; allowed: one of them called time"):
        read_timed(["1", "2"], 1, ["speed [rpm]"], ";", "x.log")


def test_lines_whose_width_is_the_same_in_less_than_half_of_them_are_no_table():
    widths = [",".join("1" * count) for count in (2, 2, 3, 4, 5)]
    assert find_layout(widths) is None
    assert find_layout([*widths, "1,1"]) is not None
