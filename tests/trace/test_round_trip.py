"""Whatever numbers a file of any format holds, they are read as they were written; tables of results to nine digits."""

import gzip
import io
import json
import os
from unittest.mock import patch

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from asammdf import MDF, Signal
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from mcap_ros2.writer import Writer
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from bench.diagnosis.replay import Replay
from bench.plant.drive import References
from bench.trace.read import read_recording
from tests.trace.recordings import machine_expert_xml

COUNT = 12
TIME = np.arange(COUNT)
FINITE = st.floats(allow_nan=False, allow_infinity=False)
NUMBERS = arrays(np.float64, (2, COUNT), elements=FINITE)
SEVERAL = settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)


def lines(separator, *columns, decimal="."):
    cells = ([repr(float(value)).replace(".", decimal) for value in column] for column in columns)
    return "".join(separator.join(row) + "\n" for row in zip(*cells, strict=True))


def table(a, b):
    return f"t [s],a [V],b [V]\n{lines(',', TIME, a, b)}".encode()


def epos(a, b):
    head = "EPOS Studio Version:;3\r\n;a;b\r\nms;V;V\r\n"
    return (head + lines(";", TIME, a, b, decimal=",").replace("\n", "\r\n")).encode()


def twincat(a, b):
    head = "Name\tp\nStarttime of export\t132959733843760000\n\nName\ta\tb\nUnit\tV\tV\n\n"
    return (head + lines("\t", TIME, a, b)).encode()


def codesys_csv(a, b):
    text = "[key]; [value]\nFlags; 16\n"
    for k, (name, values) in enumerate({"a": a, "b": b}.items()):
        rows = "".join(f"; {t}; {value!r}\n" for t, value in zip(TIME.tolist(), values.tolist(), strict=True))
        text += f"{k}.Variable; {name}\n{k}.Data; \n{rows}"
    return text.encode()


def codesys_xml(a, b):
    return machine_expert_xml({"a": (TIME, a), "b": (TIME, b)}).replace("utf-16", "utf-8")


def bam(a, b):
    entries = [
        {"timestamp": float(t), "position": x, "speed": y, "load": 5, "input_volts": 7, "temp": 30, "goal_position": 0}
        for t, x, y in zip(TIME, a.tolist(), b.tolist(), strict=True)
    ]
    return json.dumps({"mass": 1.0, "entries": entries}).encode()


def in_file(write):
    def written(a, b):
        file = io.BytesIO()
        write(file, {"t": TIME.astype(np.float64), "a": a, "b": b})
        return file.getvalue()

    return written


def hdf5(file, columns):
    with h5py.File(file, "w") as store:
        for name, values in columns.items():
            store[name] = values


def tdms(file, columns):
    with TdmsWriter(file) as writer:
        writer.write_segment([ChannelObject("axis", name, values) for name, values in columns.items()])


def mcap(file, columns):
    writer = Writer(file)
    number = writer.register_msgdef("std_msgs/msg/Float64", "float64 data")
    for name in ("a", "b"):
        for time, value in zip(columns["t"], columns[name].tolist(), strict=True):
            stamp = int(time * 1e9)
            writer.write_message(f"/{name}", number, {"data": value}, log_time=stamp, publish_time=stamp)
    writer.finish()


def mdf(a, b):
    with MDF(version="4.10") as file:
        time = TIME.astype(np.float64)
        file.append([Signal(values, time, name=name, unit="V") for name, values in {"a": a, "b": b}.items()])
        stored = io.BytesIO()
        file.save(stored)
        return stored.getvalue()


WRITERS = {
    "CSV": table,
    "CSV with semicolons": lambda a, b: f"t [s];a [V];b [V]\n{lines(';', TIME, a, b, decimal=',')}".encode(),
    "CSV with tabs": lambda a, b: f"t [s]\ta [V]\tb [V]\n{lines(chr(9), TIME, a, b)}".encode("utf-16"),
    "gzip": lambda a, b: gzip.compress(table(a, b)),
    "EPOS": epos,
    "TwinCAT": twincat,
    "CODESYS CSV": codesys_csv,
    "CODESYS text": lambda a, b: f"T\nP\nTimestamp(ms) a b\n{lines(' ', TIME, a, b)}".encode(),
    "CODESYS XML": lambda a, b: codesys_xml(a, b).encode(),
    "BAM": bam,
    "MAT": in_file(savemat),
    "NPZ": in_file(lambda file, columns: np.savez(file, **columns)),
    "NPY": in_file(lambda file, columns: np.save(file, np.column_stack(list(columns.values())))),
    "HDF5": in_file(hdf5),
    "TDMS": in_file(tdms),
    "MCAP": in_file(mcap),
    "MDF4": mdf,
    "Parquet": in_file(lambda file, columns: pq.write_table(pa.table(columns), file)),
}


@SEVERAL
@given(numbers=NUMBERS)
@example(numbers=np.full((2, COUNT), 100000000.5625))  # as long as an instant of an epoch, of which distances count
@pytest.mark.parametrize("name", WRITERS)
def test_numbers_are_read_as_they_were_written(tmp_path, name, numbers):
    (tmp_path / "run").write_bytes(WRITERS[name](*numbers))
    with patch.dict(os.environ, SERVOBENCH_WATCHED="1"):  # MDF4 in this process, not in one for each example
        recording = read_recording(tmp_path / "run")
    held = {channel.values.tobytes() for channel in recording.channels}
    for values in numbers:
        assert values.tobytes() in held


def assert_holds(path, text, *columns):
    path.write_text(text)
    for channel, values in zip(read_recording(path).channels, columns, strict=True):
        np.testing.assert_allclose(channel.values, values, rtol=1e-8, atol=0.0)


@SEVERAL
@given(numbers=NUMBERS, hole=st.integers(0, COUNT - 1))
def test_a_replay_comes_back(tmp_path, numbers, hole):
    """What the model says nothing of is an empty cell."""
    measured, simulated = numbers
    simulated[hole] = np.nan
    columns = (TIME, measured, simulated, measured, simulated)
    replay = Replay(TIME, measured, simulated, *columns[1:], speed_unit="rad/s", effort_unit="N*m")
    assert_holds(tmp_path / "replay.csv", replay.csv(), *columns)


@SEVERAL
@given(numbers=NUMBERS)
def test_a_motion_for_a_controller_comes_back(tmp_path, numbers):
    position, velocity = numbers
    motion = References(1e-3 * TIME, position, velocity, velocity)
    text = motion.csv(1e-3, ("rad", 1.0), ("rad/s", 1.0))
    assert_holds(tmp_path / "motion.csv", text, motion.time, position, velocity, velocity)
