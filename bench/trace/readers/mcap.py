"""Readers of MCAP (ROS 2 bags, Foxglove), by mcap and mcap-ros2-support, and of bags of ROS as folders, by rosbags.

They hold joint states, and plain numbers of any message.

`sensor_msgs/msg/JointState` gives a position, velocity and effort of each joint, in rad, rad/s and N*m (REP 103); a
joint is an axis. Of other messages in ROS 2's encoding or in JSON every number is a channel, `topic.field`. Times are
those of `header.stamp`, else those of the log.
"""

from __future__ import annotations

import json
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from bench.bounds import require_expansion, require_size
from bench.errors import InputError
from bench.files import opened
from bench.trace.channel import Channel, Recording, with_shared_times
from bench.trace.readers.containers import library, reading, unpack
from bench.trace.source import FileFormat, Source, begins

#: Topic, type, time of the log - ns - and content of a message.
_Logged = tuple[str, str, int, Any]
_JOINT_STATE = ("sensor_msgs/msg/JointState", "sensor_msgs/JointState")
_JOINT_UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N*m"}
#: Numbers of a message, and messages in one another; a scope has fewer, a point cloud more.
_MOST, _DEEPEST = 256, 8
#: Bytes of a number and its times.
_WIDTH = 24


@dataclass
class _Column:
    """Numbers of one field of a topic as they come, with the times of the log and their own in ns."""

    unit: str | None = None
    axis: str | None = None
    logged: array[int] = field(default_factory=lambda: array("q"))
    times: array[int] = field(default_factory=lambda: array("q"))
    values: array[float] = field(default_factory=lambda: array("d"))


def _read(source: Source) -> Recording:
    unread: dict[str, str] = {}
    return _recording(_messages(source, unread), unread, MCAP.format, source.path, len(source.content))


def _read_bag(source: Source) -> Recording:
    highlevel, typesys = (library(f"rosbags.{part}", source.path, BAG.format) for part in ("highlevel", "typesys"))
    folder = Path(source.path).parent
    size = sum(file.stat().st_size for file in folder.iterdir())
    require_size(folder, size)
    for file in folder.iterdir():
        with opened(file, "a file of a bag"):
            pass  # an input from now on, which rosbags opens itself

    def messages() -> Iterator[_Logged]:
        usual = typesys.get_typestore(typesys.Stores.LATEST)  # of a bag without definitions
        with highlevel.AnyReader([folder], default_typestore=usual) as bag:
            known = [one for one in bag.connections if one.msgtype in bag.typestore.types]
            for one, logged, data in bag.messages(known):
                yield one.topic, one.msgtype, logged, bag.deserialize(data, one.msgtype)

    return _recording(messages(), {}, BAG.format, str(folder), size)


def _recording(
    messages: Iterable[_Logged], unread: Mapping[str, str], container: str, origin: str, size: int
) -> Recording:
    """Channels of the numbers in messages out of `size` bytes; `unread`: topics left out meanwhile, and why."""
    columns: dict[tuple[str, str], _Column] = {}
    numbers = 0
    with reading(origin, container):
        for topic, schema, logged, message in messages:
            stamp = _stamp(message, logged)
            for path, value, unit, joint in _fields(schema, message):
                column = columns.setdefault((topic, path), _Column(unit, joint))
                column.logged.append(logged)
                column.times.append(stamp)
                column.values.append(value)
                numbers += 1
            require_expansion(origin, numbers * _WIDTH, size)
    notes = tuple(f"{topic} left out: messages in {encoding}" for topic, encoding in unread.items())
    first = min((column.times[np.argmin(column.logged)] for column in columns.values()), default=0)
    several = len({topic for (topic, _), column in columns.items() if column.axis is not None}) > 1
    channels = [
        _channel(topic, name, column, first, several, origin)
        for (topic, name), column in columns.items()
        if len(column.values) > 1
    ]
    if not channels:
        raise InputError(
            origin,
            f"contains no message of numbers ({'; '.join(notes) or 'no messages'})",
            "allowed: joint states or numbers, in ROS 2's encoding (cdr) or JSON",
        )
    return Recording(with_shared_times(channels), container, origin, notes=notes)


MCAP = FileFormat("MCAP", (".mcap",), begins(b"\x89MCAP0\r\n"), _read)
#: By its metadata.yaml, which lists the files of the bag.
BAG = FileFormat("ROS 2 bag", (), begins(b"rosbag2_bagfile_information:"), _read_bag)


def _messages(source: Source, unread: dict[str, str]) -> Iterator[_Logged]:
    """Topic, schema's name, time - ns - and content of each message that can be decoded."""
    ros2 = library("mcap_ros2.decoder", source.path, MCAP.format).DecoderFactory()
    records = library("mcap.records", source.path, MCAP.format)
    schemas: dict[int, Any] = {}
    channels: dict[int, Any] = {}
    decoders: dict[int, Callable[[bytes], Any] | None] = {}
    for record in _records(source):
        if isinstance(record, records.Schema):
            schemas[record.id] = record
        elif isinstance(record, records.Channel):
            channels.setdefault(record.id, record)
        elif isinstance(record, records.Message):
            channel = channels[record.channel_id]
            schema = schemas[channel.schema_id] if channel.schema_id else None  # 0: none
            if channel.id not in decoders:
                encoding = channel.message_encoding
                decoders[channel.id] = json.loads if encoding == "json" else ros2.decoder_for(encoding, schema)
                if decoders[channel.id] is None:
                    unread[channel.topic] = encoding or "an unknown encoding"
            decode = decoders[channel.id]
            if decode is not None:
                yield channel.topic, schema.name if schema is not None else "", record.log_time, decode(record.data)


def _records(source: Source) -> Iterator[Any]:
    """Records in the file's order, those of chunks too, which are unpacked one at a time within the bounds.

    Checksums are compared where the file has them.
    """
    reader = library("mcap.stream_reader", source.path, MCAP.format)
    size = 0
    for record in reader.StreamReader(BytesIO(source.content), emit_chunks=True, validate_crcs=True).records:
        if not isinstance(record, reader.Chunk):
            yield record
            continue
        size += record.uncompressed_size
        require_expansion(source.path, size, len(source.content))
        data = unpack(record.data, record.uncompressed_size) if record.compression else record.data
        yield from reader.breakup_chunk(replace(record, compression="", data=data), validate_crc=True)


def _fields(schema: str, message: Any) -> Iterator[tuple[str, float, str | None, str | None]]:  # noqa: ANN401
    """Path and value of each number of a message; of a joint state with its unit and the joint."""
    if schema not in _JOINT_STATE:
        yield from ((path, value, None, None) for path, value in islice(_numbers(message, "", 0), _MOST))
        return
    for number, joint in enumerate(message.name):
        for name, unit in _JOINT_UNITS.items():
            values = getattr(message, name)
            if len(values) == len(message.name):
                yield f"{joint}.{name}", values[number], unit, joint


def _stamp(message: Any, logged: int) -> int:  # noqa: ANN401
    """Time of a message - ns: of its header where that has one."""
    stamp = _part(_part(message, "header"), "stamp")
    seconds = _part(stamp, "sec")
    if not isinstance(seconds, int):
        return logged
    nanoseconds = _part(stamp, "nanosec") or _part(stamp, "nsec") or 0
    return (seconds * 10**9 + int(nanoseconds)) or logged


def _part(message: Any, name: str) -> Any:  # noqa: ANN401
    return message.get(name) if isinstance(message, dict) else getattr(message, name, None)


def _numbers(message: Any, path: str, depth: int) -> Iterator[tuple[str, float]]:  # noqa: ANN401
    """Path and value of every number in a message but its header."""
    if depth > _DEEPEST:
        return
    if isinstance(message, bool | int | float | np.number):
        yield path, float(message)
    elif isinstance(message, dict):
        for name, value in message.items():
            yield from _numbers(value, f"{path}.{name}" if path else name, depth + 1)
    elif isinstance(message, list | tuple | array | np.ndarray):
        for number, value in enumerate(message[:_MOST]):
            yield from _numbers(value, f"{path}[{number}]", depth + 1)
    elif not isinstance(message, str | bytes):
        for name in getattr(message, "__slots__", None) or getattr(message, "__dict__", ()):
            if name not in ("header", "__msgtype__"):
                yield from _numbers(getattr(message, name), f"{path}.{name}" if path else name, depth + 1)


def _channel(topic: str, name: str, column: _Column, first: int, several: bool, path: str) -> Channel:
    """Channel of a column; where several topics have joint states, the topic is put before the joint."""
    axis = column.axis
    label = f"{topic}.{name}"
    if axis is not None:
        label = name.removeprefix(f"{axis}.")
        axis = f"{topic}/{axis}" if several else axis
    order = np.argsort(column.logged, kind="stable")
    times = np.asarray((np.array(column.times, dtype=np.int64)[order] - first) * 1e-9, dtype=np.float64)
    time = Channel(f"{label} time", "s", times, path, axis=axis)
    return Channel(label, column.unit, np.array(column.values)[order], path, time=time, axis=axis)
