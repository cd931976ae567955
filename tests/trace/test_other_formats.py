import json
import struct
import zlib

import numpy as np
import pytest
from scipy.io import loadmat, savemat

from bench.errors import InputError
from bench.trace.choose import GivenOptions
from bench.trace.read import read, read_recording
from bench.trace.trace import assemble
from tests.trace.recordings import shared

TWINCAT = (
    "tc3_default.csv",
    "tc3_ContainEOF_true.csv",
    "tc3_DecimalMark_,.csv",
    "tc3_Seperator_3.csv",
    "tc3_ExcludeDoubleTimestamp_true-SortChannels_false.csv",
)


@pytest.mark.parametrize("name", TWINCAT)
def test_every_twincat_dialect_holds_the_same_recording(name):
    recording = read_recording(shared("formats", name))
    channels = {channel.name: channel for channel in recording.channels}
    assert len(channels) == 21
    counter = np.arange(1000.0)
    for plain in ("var_INT16", "var_UINT64", "var_REAL32", "var_REAL64", "test space", "test_special([{äöü!?ß$²}])"):
        assert np.array_equal(channels[plain].values, counter), plain
    assert channels["func_units_unscaled"].unit == "V (Voltage)"
    # the default export does not scale values, the others do; the header is the same, so the unit is open
    scaled = name != "tc3_default.csv"
    assert channels["func_units_scaled"].unit is None
    assert np.array_equal(channels["func_units_scaled"].values, 10.0 - 10.0 * counter if scaled else counter)
    assert np.array_equal(channels["func_scaled"].values, 1.0 - counter if scaled else counter)
    fast, free = channels["func_OS"], channels["func_freesample"]
    assert fast.time is not None and free.time is not None
    np.testing.assert_allclose(fast.time.values, 0.2 * np.arange(fast.values.size), atol=1e-9)
    assert free.time.values[:2].tolist() == [-3.0, 2.0] and free.values[:2].tolist() == [997.0, 2.0]
    assert channels["var_INT16"].time is channels["var_REAL64"].time
    assert recording.metadata["starttime of export"].startswith("2022-05-02T13:56:24.376")


def test_twincat_trace_takes_the_unit_of_the_file():
    columns = {"voltage": "func_units_unscaled", "velocity": "var_REAL64 [deg/s]", "current": "func_OS [mA]"}
    trace = read(shared("formats", "tc3_default.csv"), columns)
    assert np.array_equal(trace["voltage"], np.arange(1000.0))
    np.testing.assert_allclose(trace["current"], np.arange(1000) * 1e-3, atol=1e-12)  # 5 times oversampled ramp
    with pytest.raises(InputError, match=r"column 'var_INT16.*has no unit"):
        read(shared("formats", "tc3_default.csv"), {"velocity": "var_INT16"})
    with pytest.raises(InputError, match=r"open unit: the header names 'dV .Voltage.' and Unit Offset 10"):
        read(shared("formats", "tc3_default.csv"), {"voltage": "func_units_scaled"})
    stated = read(shared("formats", "tc3_default.csv"), {"voltage": "func_units_scaled [mV]"})
    np.testing.assert_allclose(stated["voltage"], np.arange(1000) * 1e-3)


TWINCAT_HEAD = "Name\tproject\nStarttime of export\t1\n\nName\tvelocity\tName\tcurrent\nUnit\trad/s\tUnit\tA\n\n"


def test_twincat_full_time_stamps_and_cells_left_empty_by_a_slower_channel(tmp_path):
    stamps = [132959733843760001 + 10_000 * k for k in range(50)]  # too large for a float to tell 100 ns
    rows = [f"{t}\t{k}\t" + (f"{t}\t{k}" if k % 5 == 0 else "\t") for k, t in enumerate(stamps)]
    (tmp_path / "run.csv").write_text(TWINCAT_HEAD + "\n".join(rows))
    trace = read(tmp_path / "run.csv")
    assert trace.sample_period == pytest.approx(1e-3, rel=1e-12)
    np.testing.assert_allclose(trace["current"], np.arange(46), atol=1e-9)


def test_twincat_rows_begin_where_the_first_channel_has_no_sample_yet(tmp_path):
    rows = ["\t\t0\t1.5", *(f"{k}\t{k}\t{k}\t1.5" for k in range(1, 20))]
    (tmp_path / "run.csv").write_text(TWINCAT_HEAD + "\n".join(rows))
    sizes = {channel.name: channel.values.size for channel in read_recording(tmp_path / "run.csv").channels}
    assert sizes == {"velocity": 19, "current": 20}


def test_twincat_with_commas_and_a_truncated_end(tmp_path):
    text = "Name,project\nStarttime of export,132959733843760000\n\nName,velocity,torque\nUnit,rad/s,Nm\n\n"
    text += "0,1.5,2\n1,2.5,3\n2,3.5,4\n"
    path = tmp_path / "run.csv"
    path.write_text(text)
    assert read(path)["torque"].tolist() == [2, 3, 4]
    path.write_text(text[: text.rindex(",")])
    with pytest.raises(InputError, match="truncated"):
        read(path)


def test_emps_in_the_units_the_rig_gives():
    path = shared("emps", "DATA_EMPS.mat")
    raw = loadmat(path)
    trace = read(path, {"time": "t [s]", "position": "qm [m]", "position_reference": "qg [m]", "voltage": "vir [V]"})
    assert not trace.axis_kind.turns and len(trace) == 24841 and len(trace.segments) == 1
    assert trace.sample_period == pytest.approx(1e-3, rel=1e-9)
    assert trace.time_base is not None and not trace.time_base.resampled
    assert np.array_equal(trace["position"], raw["qm"][:, 0])
    assert np.array_equal(trace["voltage"], raw["vir"][:, 0])
    assert float(trace.metadata["gtau"]) == pytest.approx(35.15065188248547)
    with pytest.raises(InputError, match="position or velocity: not in the file"):
        read(path)


def test_emps_pulses_are_numbers_before_arithmetic():
    path = shared("emps", "DATA_EMPS_PULSES.mat")
    columns = {"time": "t [s]", "position": "qm [m]", "force": "-pulses_N [N]"}
    assert set(np.unique(read(path, columns)["force"]).tolist()) == {-5.0, 0.0}


def test_epos_example():
    trace = read(shared("formats", "epos_recorder_example.csv"))
    assert dict(trace.units) == {"velocity": "rad/s", "torque": "dimensionless"}
    assert trace.sample_period == pytest.approx(0.040) and len(trace) == 500


def test_a_cell_of_an_epos_recording_that_is_no_number_is_found_on_its_line(tmp_path):
    lines = ["EPOS Studio Version:;3", ";Velocity actual value;Torque actual value", "ms;rpm;%"]
    lines += [f"{k};{k * k};1,5" for k in range(100)]
    lines[41] = "38;x;1,5"
    (tmp_path / "axis.csv").write_text("\r\n".join(lines), encoding="utf-8")
    with pytest.raises(InputError, match="line 42, column 'Velocity actual value"):
        read(tmp_path / "axis.csv")


@pytest.mark.parametrize(("name", "remark"), [("1.csv", "was -8.9"), ("2.csv", "was -11.1"), ("n1.csv", "was 22.1")])
def test_epos_samples_changed_by_hand_are_left_out_and_reported(name, remark):
    trace = read(shared("tro2021_screw", "driveNo3", "steady_state", "0.096kg", name))
    assert len(trace) == 499
    assert any(remark in note and "line 15 left out" in note for note in trace.notes)
    assert np.abs(trace["torque"]).max() < 1.0


def test_every_epos_recording_is_read():
    files = sorted(shared("tro2021_screw").rglob("*.csv"))
    assert len(files) == 114
    for path in files:
        trace = read(path, {"torque": "-Torque actual value averaged [%]"})
        assert len(trace) >= 499 and len(trace.segments) == 1


def test_bam_recording():
    path = shared("bam_xl330", "2026-01-15_10h28m10.json")
    content = json.loads(path.read_text())
    trace = read(path)
    recording = {channel.name: channel.values for channel in read_recording(path).channels}
    loads = np.array([e["load"] - 65536 if e["load"] > 32767 else e["load"] for e in content["entries"]])
    volts = np.array([e["input_volts"] for e in content["entries"]])
    assert loads.min() < 0 < loads.max()
    np.testing.assert_allclose(recording["voltage"], loads / 885 * volts, rtol=1e-12)
    assert np.abs(trace["voltage"]).max() <= volts.max() * 1.001
    assert 290 < trace["temperature"].min() < 330
    assert trace.metadata["mass"] == "0.49" and trace.metadata["kp"] == "100"
    assert 150 < 1 / trace.sample_period < 300
    assert trace.time_base is not None and trace.time_base.resampled


def test_frequency_response_is_refused():
    with pytest.raises(InputError, match="frequency-response measurement, which contains no motion"):
        read(shared("formats", "freq_trace.XML"))


def test_mat_structs_cells_and_matrices(tmp_path):
    time = np.arange(100) * 1e-3
    runs = np.zeros((1, 2), dtype=[("t_s", object), ("w_rad_s", object)])
    runs[0, 0], runs[0, 1] = (time, 2.0 * time), (time + 1.0, 3.0 * time)
    cells = np.empty((1, 2), dtype=object)
    cells[0, :] = [time, 5.0 * time]
    log = {"t": time, "both": np.column_stack([time, 2 * time])}
    savemat(tmp_path / "run.mat", {"run": runs, "cell": cells, "log": log, "name": "axis"})
    recording = read_recording(tmp_path / "run.mat")
    assert [channel.name for channel in recording.channels][:6] == [
        *(f"run.{place}.{name}" for place in (1, 2) for name in ("t_s", "w_rad_s")),
        *("cell.1", "cell.2"),
    ]
    for clock, speed, shift, factor in (
        ("run.2.t_s", "run.2.w_rad_s", 1.0, 3.0),
        ("cell.1 [s]", "cell.2 [rad/s]", 0.0, 5.0),
        ("log.t [s]", "log.both(:,2) [rad/s]", 0.0, 2.0),
    ):
        trace = read(tmp_path / "run.mat", {"time": clock, "velocity": speed})
        np.testing.assert_allclose(trace.time, time + shift)
        np.testing.assert_allclose(trace["velocity"], factor * time)
    assert trace.metadata["name"] == "axis"
    np.testing.assert_allclose(assemble(recording, GivenOptions(axis="run.2")).time, time + 1.0)


def test_iddata_in_a_struct(tmp_path):
    """System Identification Toolbox: `s = get(d)` has the samples, their names and units, and the sample time."""
    values = np.random.default_rng(1).standard_normal((100, 3))
    names = {"OutputName": np.array([["position"], ["velocity"]], dtype=object), "InputName": "current"}
    units = {"OutputUnit": np.array([["deg"], ["deg/s"]], dtype=object), "InputUnit": "mA", "TimeUnit": "milliseconds"}
    data = {"OutputData": values[:, :2], "InputData": values[:, 2:], "Ts": 2.0, "Tstart": 4.0, **names, **units}
    savemat(tmp_path / "run.mat", {"s": {**data, "SamplingInstants": np.empty((0, 0))}})
    trace = read(tmp_path / "run.mat")
    np.testing.assert_allclose(trace.time, 4e-3 + 2e-3 * np.arange(100))
    np.testing.assert_allclose(trace["position"], np.radians(values[:, 0]))
    np.testing.assert_allclose(trace["velocity"], np.radians(values[:, 1]))
    np.testing.assert_allclose(trace["current"], 1e-3 * values[:, 2])


@pytest.mark.parametrize("packed", [False, True])
def test_an_object_of_matlab_is_refused_with_what_to_run_there(tmp_path, packed):
    def element(kind, data):
        return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)

    flags = [element(6, struct.pack("<II", kind, 0)) for kind in (17, 13)]
    handle = flags[1] + element(5, struct.pack("<ii", 6, 1)) + element(1, b"") + element(6, bytes(24))
    opaque = flags[0] + element(1, b"T") + element(1, b"MCOS") + element(1, b"table") + element(14, handle)
    body = element(14, opaque)
    if packed:
        body = struct.pack("<II", 15, len(zlib.compress(body))) + zlib.compress(body)
    header = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM"
    (tmp_path / "run.mat").write_bytes(header + body)
    with pytest.raises(InputError, match=r"contains an object of MATLAB .* writetable\(T, 'run.csv'\)"):
        read(tmp_path / "run.mat")
