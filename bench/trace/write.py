"""Write a trace: canonical CSV, Parquet, a Machine Expert trace, or joint states of ROS 2; whole or not at all."""

from __future__ import annotations

import gzip
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import IO

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow import csv

from bench.arrays import Array
from bench.errors import InputError
from bench.files import whole
from bench.trace.readers.codesys import LAB_UNITS, machine_expert_trace
from bench.trace.readers.containers import library
from bench.trace.readers.mcap import MCAP
from bench.trace.signals import scale_in
from bench.trace.trace import Trace
from bench.units import same_dimension


def write(trace: Trace, path: str | Path, units: Mapping[str, str] | None = None) -> None:
    """Write a trace in the format its file's ending names: `.csv`, `.csv.gz`, `.parquet`, `.trace`.

    Reading it back gives the same floats where `units` keeps SI units. A Machine Expert trace keeps times
    to the microsecond and, as the lab does, angles in degrees and currents in mA.

    Args:
        trace: what to write.
        path: file to write or replace.
        units: unit of a signal, or of `time`, in the file; SI where none is given.

    Raises:
        InputError: another ending, a unit of the wrong dimension, or a place that cannot be written to.
    """
    path = Path(path)
    ending = "".join(path.suffixes[-2:]).lower() if path.suffix.lower() == ".gz" else path.suffix.lower()
    if ending not in WRITERS:
        raise InputError(path, f"found the ending '{ending}'", f"allowed: {', '.join(WRITERS)}")
    si = {"time": "s", **trace.units}
    labels = dict(si)
    if ending == ".trace" and trace.axis_kind.turns:
        labels |= {
            name: unit for name, unit in LAB_UNITS.items() if name in trace and same_dimension(unit, labels[name])
        }
    for name, unit in (units or {}).items():
        where = f"{path}: unit of {name}"
        if name not in labels:
            raise InputError(where, "the trace contains no such signal", f"allowed: {', '.join(labels)}")
        if scale_in(name, unit, where).unit != si[name]:
            raise InputError(where, f"found '{unit}'", f"allowed: a unit of {si[name]}")
        labels[name] = unit
    columns = {}
    for name, values in {"time": trace.time, **trace.signals}.items():
        scale = scale_in(name, labels[name], name)
        plain = scale.factor == 1.0 and not scale.offset
        columns[f"{name} [{labels[name]}]"] = values if plain else (values - scale.offset) / scale.factor
    with whole(path) as temporary, temporary.open("wb") as file:
        WRITERS[ending](pa.table(columns), file)


def _csv(table: pa.Table, file: IO[bytes] | gzip.GzipFile) -> None:
    file.write((",".join(table.column_names) + "\n").encode())
    csv.write_csv(table, file, csv.WriteOptions(include_header=False))


def _csv_gz(table: pa.Table, file: IO[bytes]) -> None:
    # no name and no time inside, so that the same trace gives the same bytes
    with gzip.GzipFile("", "wb", fileobj=file, mtime=0) as packed:
        _csv(table, packed)


#: Files are opened first: Arrow itself opens no name that is not UTF-8.
WRITERS: dict[str, Callable[[pa.Table, IO[bytes]], object]] = {
    ".csv": _csv,
    ".csv.gz": _csv_gz,
    ".parquet": partial(pq.write_table, write_page_checksum=True),  # by which a reader sees a bit that has flipped
    ".trace": lambda table, file: file.write(machine_expert_trace(table)),
}


STATE = "sensor_msgs/msg/JointState"
#: Of the message, as ROS 2 has it (REP 103: rad or m, N*m or N).
DEFINITION = """std_msgs/Header header
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
uint32 nanosec
"""


def write_joint_states(path: Path, joint: str, time: Array, topics: Mapping[str, Mapping[str, Array]]) -> None:
    """Write states of a joint over time to MCAP, which Foxglove, Rerun and PlotJuggler open, a topic each.

    Args:
        path: file to write or replace.
        joint: its name in the messages.
        time: s (n,); from the first where that is below zero, which no stamp can be.
        topics: `position`, `velocity`, `effort` - rad, rad/s, N*m (m, m/s, N) - (n,) by topic; nan where unknown, left
            out where that is everywhere.

    Raises:
        InputError: mcap is not installed, or the file cannot be written.
    """
    ros2 = library("mcap_ros2.writer", str(path), MCAP.format)
    stamps = np.round((time - min(float(time[0]), 0.0)) * 1e9).astype(np.int64).tolist()
    known = {
        topic: {name: values.tolist() for name, values in signals.items() if np.isfinite(values).any()}
        for topic, signals in topics.items()
    }
    empty = dict.fromkeys(("position", "velocity", "effort"), ())
    with whole(path) as temporary, temporary.open("wb") as file:
        writer = ros2.Writer(file)
        schema = writer.register_msgdef(STATE, DEFINITION)
        for k, stamp in enumerate(stamps):
            header = {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": ""}
            for topic, signals in known.items():
                state = {name: [values[k]] for name, values in signals.items()}
                message = {"header": header, "name": [joint], **empty, **state}
                writer.write_message(topic, schema, message, log_time=stamp, publish_time=stamp)
        writer.finish()
