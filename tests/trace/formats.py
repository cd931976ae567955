"""Files of every format, each by its own library or in its own layout: a time in ms, a velocity and a current."""

from __future__ import annotations

import gzip
import io
import json

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from asammdf import MDF, Signal
from mcap_ros2.writer import Writer
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from bench.trace.write import DEFINITION
from tests.trace.recordings import machine_expert_xml

#: What a user states of a format whose columns have no unit or another name.
COLUMNS = {
    "MCAP": {"velocity": "/velocity [rad/s]", "current": "/current [A]"},
    "NPY": {"time": "column 1 [ms]", "velocity": "column 2 [rad/s]", "current": "column 3 [A]"},
}
for name in ("MAT", "NPZ", "HDF5", "TDMS", "Parquet"):
    COLUMNS[name] = {"time": "time [ms]", "velocity": "velocity [rad/s]", "current": "current [A]"}


def bag(path, time, joints, states, stamped=True, topics=()):
    """A ROS 2 bag of joint states, and of topics with a number each; the log is late, now more, now less.

    Args:
        time: (n,) - s.
        joints: their names; none for no states.
        states: positions, velocities and efforts of an instant (n, 3, joints).
        stamped: whether the messages have their own times.
        topics: names and numbers (n,).
    """
    with path.open("wb") as file:
        writer = Writer(file)
        kind = writer.register_msgdef("sensor_msgs/msg/JointState", DEFINITION)
        number = writer.register_msgdef("std_msgs/msg/Float64", "float64 data")
        for k, t in enumerate(time):
            stamp = 1_700_000_000_000_000_000 + round(t * 1e9)
            sec, nanosec = divmod(stamp, 10**9) if stamped else (0, 0)
            message = {"header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""}, "name": list(joints)}
            if joints:
                message |= zip(("position", "velocity", "effort"), np.asarray(states[k]).tolist(), strict=True)
                logged = stamp + 137_000 * (k % 5)
                writer.write_message("/joint_states", kind, message, log_time=logged, publish_time=stamp)
            for topic, values in topics:
                writer.write_message(topic, number, {"data": float(values[k])}, log_time=stamp, publish_time=stamp)
        writer.finish()
    return path


def lines(separator, *columns, decimal="."):
    cells = ([repr(float(value)).replace(".", decimal) for value in column] for column in columns)
    return "".join(separator.join(row) + "\n" for row in zip(*cells, strict=True))


def table(*columns, separator=",", decimal="."):
    head = separator.join(("time [ms]", "velocity [rad/s]", "current [A]"))
    return f"{head}\n{lines(separator, *columns, decimal=decimal)}"


def epos(*columns):
    head = "EPOS Studio Version:;3\n;velocity;current\nms;rad/s;A\n"
    return (head + lines(";", *columns, decimal=",")).replace("\n", "\r\n")


def twincat(*columns):
    head = "Name\tp\nStarttime of export\t132959733843760000\n\nName\tvelocity\tcurrent\nUnit\trad/s\tA\n\n"
    return head + lines("\t", *columns)


def codesys_csv(time, velocity, current):
    text = "[key]; [value]\nFlags; 16\n"
    for k, (name, values) in enumerate({"Velocity": velocity, "Current": current}.items()):
        rows = "".join(f"; {t:.0f}; {value!r}\n" for t, value in zip(time, values.tolist(), strict=True))
        text += f"{k}.Variable; A.{name}\n{k}.Data; \n{rows}"
    return text


def codesys_xml(time, velocity, current):
    return machine_expert_xml({"A.Velocity": (time, velocity), "A.Current": (time, current)})


def bam(time, position, speed):
    others = {"load": 5, "input_volts": 7, "temp": 30, "goal_position": 0}
    entries = [
        {"timestamp": 1e-3 * float(t), "position": x, "speed": w, **others}
        for t, x, w in zip(time, position.tolist(), speed.tolist(), strict=True)
    ]
    return json.dumps({"mass": 1.0, "entries": entries})


def stored(save):
    """What a library saves in a file of three columns."""

    def written(time, velocity, current):
        file = io.BytesIO()
        save(file, {"time": time.astype(np.float64), "velocity": velocity, "current": current})
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
    time = columns.pop("time")
    for name, values in columns.items():
        for stamp, value in zip((time * 1e6).astype(int).tolist(), values.tolist(), strict=True):
            writer.write_message(f"/{name}", number, {"data": value}, log_time=stamp, publish_time=stamp)
    writer.finish()


def mdf(file, columns):
    time = 1e-3 * columns.pop("time")
    units = {"velocity": "rad/s", "current": "A"}
    with MDF(version="4.10") as measurement:
        measurement.append([Signal(values, time, name=n, unit=units[n]) for n, values in columns.items()])
        measurement.save(file)


#: Bytes of each, or text in UTF-8.
WRITERS = {
    "CSV": table,
    "CSV with semicolons": lambda *columns: table(*columns, separator=";", decimal=","),
    "CSV with tabs": lambda *columns: table(*columns, separator="\t").encode("utf-16"),
    "gzip": lambda *columns: gzip.compress(table(*columns).encode()),
    "EPOS": epos,
    "TwinCAT": twincat,
    "CODESYS CSV": codesys_csv,
    "CODESYS text": lambda *columns: f"T\nP\nTimestamp(ms) A.Velocity A.Current\n{lines(' ', *columns)}",
    "CODESYS XML": lambda *columns: codesys_xml(*columns).replace("utf-16", "utf-8"),
    "CODESYS trace": lambda *columns: b"\xff\xfe" + codesys_xml(*columns).encode("utf-16-le"),
    "BAM": bam,
    "MAT": stored(savemat),
    "NPZ": stored(lambda file, columns: np.savez(file, **columns)),
    "NPY": stored(lambda file, columns: np.save(file, np.column_stack(list(columns.values())))),
    "HDF5": stored(hdf5),
    "TDMS": stored(tdms),
    "MCAP": stored(mcap),
    "MDF4": stored(mdf),
    "Parquet": stored(lambda file, columns: pq.write_table(pa.table(columns), file)),
}


def content(name, time, velocity, current):
    """Bytes of a file of a format; times are whole ms (n,)."""
    written = WRITERS[name](time, velocity, current)
    return written.encode() if isinstance(written, str) else written
