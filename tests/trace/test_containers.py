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
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from scipy.io import savemat

from bench.bounds import bounded, bounds
from bench.errors import InputError
from bench.trace.choose import GivenOptions
from bench.trace.read import read, read_recording
from bench.trace.readers.containers import apart
from bench.trace.source import Source
from tests.trace.formats import bag, content
from tests.trace.recordings import current, velocity

TIME = np.arange(400) * 2e-3
SPEED, AMPS = np.deg2rad(velocity(TIME)), current(TIME) * 1e-3
MAPPED = {"time": "log.t [s]", "velocity": "log.w [rad/s]", "current": "log.i [A]"}
PLAIN = {"time": "t [s]", "velocity": "w [rad/s]", "current": "i [A]"}
OF_ANS = {"time": "ans(1,:) [s]", "velocity": "ans(2,:) [rad/s]", "current": "ans(3,:) [A]"}


def holds(trace, speed=SPEED):
    np.testing.assert_allclose(trace.time - trace.time[0], TIME, atol=1e-9)
    np.testing.assert_allclose(trace["velocity"], speed, rtol=1e-12, atol=1e-12)


def of_joints(path, **scales):
    """A bag of joints whose speeds are the motion's by a factor."""
    states = np.stack([np.outer(values, [*scales.values()]) for values in (TIME, SPEED, AMPS)], axis=1)
    return bag(path / "run.mcap", TIME, scales, states)


def test_a_bag_of_one_joint_needs_no_mapping(tmp_path):
    trace = read(of_joints(tmp_path, elbow=1.0))
    holds(trace)
    assert dict(trace.units) == {"position": "rad", "velocity": "rad/s", "torque": "N*m"}
    np.testing.assert_allclose(trace["torque"], AMPS)


def test_a_bag_of_several_joints_asks_which(tmp_path):
    path = of_joints(tmp_path, hip=1.0, knee=-0.5)
    with pytest.raises(InputError, match=r"found 2 axes \(hip, knee\); pick one: `--axis hip`"):
        read(path)
    holds(read(path, GivenOptions(axis="knee")), -0.5 * SPEED)
    with pytest.raises(InputError, match=r"no axis 'kne', did you mean 'knee'\?; found: hip, knee"):
        read(path, GivenOptions(axis="kne"))


def test_plain_numbers_of_a_bag_are_columns_of_their_topics(tmp_path):
    topics = [("/motor/speed", SPEED), ("/motor/amps", AMPS)]
    path = bag(tmp_path / "run.mcap", TIME, (), (), topics=topics)
    trace = read(path, {"velocity": "/motor/speed [rad/s]", "current": "-/motor/amps.data [A]"})
    holds(trace)
    np.testing.assert_allclose(trace["current"], -AMPS)


def test_without_a_header_stamp_the_log_tells_the_time(tmp_path):
    trace = read(bag(tmp_path / "run.mcap", TIME, ("elbow",), np.ones((TIME.size, 3, 1)), stamped=False))
    assert trace.time_base is not None and trace.time_base.jitter > 0.05


@pytest.mark.parametrize("timed", [True, False])
def test_groups_of_tdms_are_axes_whether_their_times_are_a_channel_or_a_waveforms(tmp_path, timed):
    waveform = {} if timed else {"wf_increment": 2e-3, "wf_start_offset": 0.0}
    groups = {"left": 1.0, "right": -1.0}
    with TdmsWriter(str(tmp_path / "run.tdms")) as writer:
        channels = [RootObject({}), *map(GroupObject, groups)]
        for group, sign in groups.items():
            if timed:
                channels.append(ChannelObject(group, "time", TIME, {"unit_string": "s"}))
            for name, values, unit in (("velocity", np.rad2deg(sign * SPEED), "deg/s"), ("current", 1e3 * AMPS, "mA")):
                channels.append(ChannelObject(group, name, values, {"unit_string": unit, **waveform}))
        writer.write_segment(channels)
    with pytest.raises(InputError, match=r"found 2 axes \(left, right\)"):
        read(tmp_path / "run.tdms")
    holds(read(tmp_path / "run.tdms", GivenOptions(axis="right")), -SPEED)


def test_hdf5_and_its_units(tmp_path):
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        for name, values in {"t": TIME, "w": SPEED, "i": AMPS}.items():
            file[f"log/{name}"] = values
        file["log/note"] = "by hand"
    holds(read(path, MAPPED))
    with h5py.File(path, "a") as file:
        file["time"], file["velocity"] = TIME * 1e3, np.rad2deg(SPEED)
        file["time"].attrs["unit"], file["velocity"].attrs["units"] = "ms", "deg/s"
    holds(read(path))


def test_mat_7_3_is_transposed_hdf5_behind_a_header(tmp_path):
    """Laid out as MATLAB saves `log` and `ans` with '-v7.3': column vectors as rows, structs as groups."""
    stored = BytesIO()
    with h5py.File(stored, "w", userblock_size=512) as file:
        for name, values in {"log/t": TIME, "log/w": SPEED, "log/i": AMPS}.items():
            file[name] = values.reshape(1, -1)
        file["ans"] = np.vstack([TIME, SPEED, AMPS]).T
        for name in ("log/t", "log/w", "log/i", "ans"):
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512, b" ")
    path = tmp_path / "run.mat"
    path.write_bytes(head + stored.getvalue()[512:])
    for columns in (MAPPED, OF_ANS):
        holds(read(path, columns))


def test_arrays_of_numpy_and_matlab(tmp_path):
    single = SPEED.astype(np.float32)
    np.savez(tmp_path / "run.npz", t=TIME, w=single, i=AMPS, joint=np.array("elbow"), odd=np.array([None]))
    holds(read(tmp_path / "run.npz", PLAIN), single.astype(float))
    fields = np.dtype([("t", float), ("w", float), ("i", float)])
    np.save(tmp_path / "named.npy", np.array(list(zip(TIME, SPEED, AMPS, strict=True)), fields))
    holds(read(tmp_path / "named.npy", PLAIN))
    savemat(tmp_path / "run.mat", {"ans": np.vstack([TIME, SPEED, AMPS])})
    holds(read(tmp_path / "run.mat", OF_ANS))


def test_what_is_no_array_in_a_zip_of_arrays_is_left_out(tmp_path):
    path = tmp_path / "log.npz"
    np.savez(path, t=TIME, w=SPEED, i=AMPS)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("readme.txt", "of the second run")
    holds(read(path, PLAIN))


def test_decimals_of_a_parquet_table_are_numbers(tmp_path):
    exact = {name: pa.array([Decimal(f"{one:.9f}") for one in values]) for name, values in (("t", TIME), ("w", SPEED))}
    pq.write_table(pa.table({**exact, "i": AMPS}), tmp_path / "run.parquet")
    holds(read(tmp_path / "run.parquet", PLAIN), np.round(SPEED, 9))


@pytest.mark.parametrize(
    ("name", "module", "extra"),
    [("MCAP", "mcap.stream_reader", "mcap"), ("TDMS", "nptdms", "tdms"), ("HDF5", "h5py", "hdf5")],
)
def test_a_missing_library_is_reported_with_how_to_install_it(tmp_path, monkeypatch, name, module, extra):
    path = tmp_path / "run"
    path.write_bytes(content(name, np.arange(9), SPEED[:9], AMPS[:9]))
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
