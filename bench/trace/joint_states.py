"""Joint states of ROS 2 in an MCAP file, which Foxglove, Rerun and PlotJuggler open, by mcap and mcap-ros2-support."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bench.arrays import Array
from bench.files import whole
from bench.trace.readers.containers import library
from bench.trace.readers.mcap import MCAP

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
    """Write states of a joint over time, a topic each; whole or not at all.

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
