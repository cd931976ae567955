"""Containers, each written by its own library: what was written is what is read."""

import os
import signal
import sys
import zipfile
from decimal import Decimal
from io import BytesIO

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from asammdf import MDF, Signal
from mcap_ros2.writer import Writer as Ros2Writer
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from scipy.io import savemat

from bench.bounds import bounded, bounds
from bench.errors import InputError
from bench.trace.choose import GivenOptions
from bench.trace.read import read, read_recording
from bench.trace.readers.containers import apart
from bench.trace.source import Source
from tests.trace.recordings import current, velocity

TIME = np.arange(400) * 2e-3
SPEED, AMPS = np.deg2rad(velocity(TIME)), current(TIME) * 1e-3
MAPPED = {"time": "log.t [s]", "velocity": "log.w [rad/s]", "current": "log.i [A]"}


def holds(trace, speed=SPEED):
    np.testing.assert_allclose(trace.time - trace.time[0], TIME, atol=1e-9)
    np.testing.assert_allclose(trace["velocity"], speed, rtol=1e-12, atol=1e-12)


JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec"""


def bag(path, joints, stamped=True, numbers=()):
    """A ROS 2 bag of joint states, and of topics with a number each."""
    with path.open("wb") as file:
        writer = Ros2Writer(file)
        states = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        number = writer.register_msgdef("std_msgs/msg/Float64", "float64 data")
        for k, time in enumerate(TIME):
            stamp = 1_700_000_000_000_000_000 + round(time * 1e9)
            logged = stamp + 137_000 * (k % 5)  # the log is late, now more, now less
            sec, nanosec = divmod(stamp, 10**9) if stamped else (0, 0)
            if joints:
                message = {
                    "header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""},
                    "name": list(joints),
                    "position": [float(k)] * len(joints),
                    "velocity": [float(scale * SPEED[k]) for scale in joints.values()],
                    "effort": [float(AMPS[k])] * len(joints),
                }
                writer.write_message("/joint_states", states, message, log_time=logged, publish_time=stamp)
            for topic, values in numbers:
                writer.write_message(topic, number, {"data": float(values[k])}, log_time=stamp, publish_time=stamp)
        writer.finish()
    return path


def test_a_bag_of_one_joint_needs_no_mapping(tmp_path):
    trace = read(bag(tmp_path / "run.mcap", {"elbow": 1.0}))
    holds(trace)
    assert dict(trace.units) == {"position": "rad", "velocity": "rad/s", "torque": "N*m"}
    np.testing.assert_allclose(trace["torque"], AMPS)


def test_a_bag_of_several_joints_asks_which(tmp_path):
    path = bag(tmp_path / "run.mcap", {"hip": 1.0, "knee": -0.5})
    with pytest.raises(InputError, match=r"found 2 axes \(hip, knee\); pick one: `--axis hip`"):
        read(path)
    holds(read(path, GivenOptions(axis="knee")), -0.5 * SPEED)
    with pytest.raises(InputError, match=r"no axis 'kne', did you mean 'knee'\?; found: hip, knee"):
        read(path, GivenOptions(axis="kne"))


def test_plain_numbers_of_a_bag_are_columns_of_their_topics(tmp_path):
    path = bag(tmp_path / "run.mcap", {}, numbers=[("/motor/speed", SPEED), ("/motor/amps", AMPS)])
    trace = read(path, {"velocity": "/motor/speed [rad/s]", "current": "-/motor/amps.data [A]"})
    holds(trace)
    np.testing.assert_allclose(trace["current"], -AMPS)


def test_without_a_header_stamp_the_log_tells_the_time(tmp_path):
    trace = read(bag(tmp_path / "run.mcap", {"elbow": 1.0}, stamped=False))
    assert trace.time_base is not None and trace.time_base.jitter > 0.05


def tdms(path, groups, timed=False):
    with TdmsWriter(str(path)) as writer:
        channels = []
        for group, sign in groups.items():
            waveform = {} if timed else {"wf_increment": 2e-3, "wf_start_offset": 0.0}
            if timed:
                channels.append(ChannelObject(group, "time", TIME, {"unit_string": "s"}))
            channels.append(
                ChannelObject(group, "velocity", np.rad2deg(sign * SPEED), {"unit_string": "deg/s", **waveform})
            )
            channels.append(ChannelObject(group, "current", 1e3 * AMPS, {"unit_string": "mA", **waveform}))
        writer.write_segment([RootObject({}), *(GroupObject(name) for name in groups), *channels])
    return path


@pytest.mark.parametrize("timed", [True, False])
def test_tdms(tmp_path, timed):
    holds(read(tdms(tmp_path / "run.tdms", {"axis": 1.0}, timed)))
    path = tdms(tmp_path / "two.tdms", {"left": 1.0, "right": -1.0}, timed)
    with pytest.raises(InputError, match=r"found 2 axes \(left, right\)"):
        read(path)
    holds(read(path, GivenOptions(axis="right")), -SPEED)


def hdf5(path):
    with h5py.File(path, "w") as file:
        for name, values in {"t": TIME, "w": SPEED, "i": AMPS}.items():
            file[f"log/{name}"] = values
        file["log/note"] = "by hand"
    return path


def test_hdf5_and_its_units(tmp_path):
    path = hdf5(tmp_path / "run.h5")
    holds(read(path, MAPPED))
    with h5py.File(path, "a") as file:
        file["time"], file["velocity"] = TIME * 1e3, np.rad2deg(SPEED)
        file["time"].attrs["unit"], file["velocity"].attrs["units"] = "ms", "deg/s"
    holds(read(path))


def test_mat_7_3_is_transposed_hdf5_behind_a_header(tmp_path):
    """Laid out as MATLAB saves `log` and `ans` with '-v7.3': column vectors as rows, structs as groups."""
    content = BytesIO()
    with h5py.File(content, "w", userblock_size=512) as file:
        for name, values in {"t": TIME, "w": SPEED, "i": AMPS}.items():
            file[f"log/{name}"] = values.reshape(1, -1)
            file[f"log/{name}"].attrs["MATLAB_class"] = np.bytes_("double")
        file["ans"] = np.vstack([TIME, SPEED, AMPS]).T
        file["ans"].attrs["MATLAB_class"] = np.bytes_("double")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512, b" ")
    path = tmp_path / "run.mat"
    path.write_bytes(head + content.getvalue()[512:])
    holds(read(path, MAPPED))
    holds(read(path, {"time": "ans(1,:) [s]", "velocity": "ans(2,:) [rad/s]", "current": "ans(3,:) [A]"}))


def test_mdf4(tmp_path):
    path = tmp_path / "run.mf4"
    with MDF(version="4.10") as file:
        speed = Signal(np.rad2deg(SPEED), TIME, name="n_act", unit="deg/s")
        file.append([speed, Signal(AMPS, TIME, name="iq", unit="A")])
        file.save(path, overwrite=True)
    trace = read(path, {"velocity": "n_act"})
    holds(trace)
    np.testing.assert_allclose(trace["current"], AMPS)


def test_npz_npy_and_mat(tmp_path):
    np.savez(
        tmp_path / "run.npz", t=TIME, w=SPEED.astype(np.float32), i=AMPS, joint=np.array("elbow"), odd=np.array([None])
    )
    columns = {"time": "t [s]", "velocity": "w [rad/s]", "current": "i [A]"}
    holds(read(tmp_path / "run.npz", columns), SPEED.astype(np.float32).astype(float))
    np.save(tmp_path / "run.npy", np.column_stack([TIME, SPEED, AMPS]))
    holds(
        read(tmp_path / "run.npy", {"time": "column 1 [s]", "velocity": "column 2 [rad/s]", "current": "column 3 [A]"})
    )
    fields = np.dtype([("t", float), ("w", float), ("i", float)])
    np.save(tmp_path / "named.npy", np.array(list(zip(TIME, SPEED, AMPS, strict=True)), fields))
    holds(read(tmp_path / "named.npy", columns))
    savemat(tmp_path / "run.mat", {"ans": np.vstack([TIME, SPEED, AMPS])})
    holds(read(tmp_path / "run.mat", {"time": "ans(1,:) [s]", "velocity": "ans(2,:) [rad/s]"}))


def test_decimals_of_a_parquet_table_are_numbers(tmp_path):
    exact = {name: pa.array([Decimal(f"{one:.9f}") for one in values]) for name, values in (("t", TIME), ("w", SPEED))}
    pq.write_table(pa.table({**exact, "i": AMPS}), tmp_path / "run.parquet")
    trace = read(tmp_path / "run.parquet", {"time": "t [s]", "velocity": "w [rad/s]", "current": "i [A]"})
    holds(trace, np.round(SPEED, 9))


WRITTEN = {
    "run.mcap": lambda path: bag(path, {"elbow": 1.0}),
    "run.tdms": lambda path: tdms(path, {"a": 1.0}),
    "run.h5": hdf5,
}


@pytest.mark.parametrize("name", WRITTEN)
@pytest.mark.parametrize("share", [0.02, 0.3, 0.7])
def test_a_truncated_container_is_reported_as_such(tmp_path, name, share):
    path = WRITTEN[name](tmp_path / name)
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    try:
        recording = read_recording(path)
    except InputError as error:
        assert "\n" not in str(error)
    else:  # what was recorded until then
        assert all(channel.values.size <= TIME.size for channel in recording.channels)


@pytest.mark.parametrize(
    ("name", "module", "extra"),
    [("run.mcap", "mcap.stream_reader", "mcap"), ("run.tdms", "nptdms", "tdms"), ("run.h5", "h5py", "hdf5")],
)
def test_a_missing_library_is_reported_with_how_to_install_it(tmp_path, monkeypatch, name, module, extra):
    path = WRITTEN[name](tmp_path / name)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(InputError, match=rf"is not installed; install it: pip install 'servobench\[{extra}\]'"):
        read_recording(path)


def deadly(source):
    os.kill(os.getpid(), signal.SIGSEGV)


def refusing(source):
    raise InputError(source.path, f"found {bounds().size:g}", "allowed: less")


def test_a_library_that_a_file_ends_with_its_process_is_read_by_another_process(monkeypatch):
    """asammdf's compiled part crashes on one of 40 files with a flipped bit."""
    monkeypatch.delenv("SERVOBENCH_WATCHED", raising=False)
    source = Source("run.mf4", b"MDF", ".mf4")
    with pytest.raises(InputError, match=r"run\.mf4: the file is truncated or damaged .*SIGSEGV"):
        apart(deadly)(source)
    with bounded("5 kB"), pytest.raises(InputError, match=r"^run\.mf4: found 5120; allowed: less$"):
        apart(refusing)(source)


def test_what_is_no_array_in_a_zip_of_arrays_is_left_out(tmp_path):
    path = tmp_path / "log.npz"
    np.savez(path, time=TIME, velocity=SPEED)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("readme.txt", "of the second run")
    holds(read(path, GivenOptions({"time": "time [s]", "velocity": "velocity [rad/s]"})))
