"""Readers of JSON: logs with a line for each sample, a list of samples or an object of columns; and BAM's recordings.

Lists of a number for each joint are channels by their place, or by the names in a list of as many texts next to them,
as a ROS joint state has it; fields of an entry are `parent.field`.

The BAM project records small servos: `entries` of position, speed, load and voltage. `load` is the share of the supply
that the bridge applies, as a signed 16-bit number with 885 for full; so the motor's voltage is load/885 * input_volts
(Robotis XL330 manual, present PWM; github.com/Rhoban/bam). Scalars next to the entries (mass, kp, ...) become metadata.
"""

from __future__ import annotations

import json
import sys

import numpy as np
import pyarrow as pa
import pyarrow.json

from bench.arrays import Array
from bench.bounds import require_columns, require_expansion
from bench.errors import InputError
from bench.names import short
from bench.structured import parse_json
from bench.trace.channel import Channel, Recording
from bench.trace.readers.arrow import DAMAGE, WIDTH, channels_of_table
from bench.trace.readers.containers import reading
from bench.trace.source import FileFormat, Source


def _recognises(source: Source) -> bool:
    """Whether it begins with an object of JSON: in a list, with a list in it, or whole in the first line of several."""
    head = source.head.lstrip()
    if head.startswith("["):
        return head[1:].lstrip().startswith("{")
    return head.startswith("{") and ("[" in head or _has_lines(source))


def _has_lines(source: Source) -> bool:
    first, _, rest = source.head.lstrip().partition("\n")
    try:
        return rest.lstrip().startswith("{") and isinstance(json.loads(first), dict)
    except (ValueError, RecursionError):
        return False


def _read(source: Source) -> Recording:
    allowed = "allowed: a line or an object for each sample, or a list for each column"
    with reading(source.path, JSON_LOG.format, DAMAGE):
        if _has_lines(source):
            options = pyarrow.json.ReadOptions(block_size=min(len(source.content) + 1, 2**31 - 1))
            tables = [pyarrow.json.read_json(pa.py_buffer(source.content), read_options=options)]
            names = {}
        else:
            content = parse_json(source.text(), source.path)
            if isinstance(content, list) and all(isinstance(row, dict) for row in content):
                keys = dict.fromkeys(key for row in content for key in row)
                content = {key: [row.get(key) for row in content] for key in keys}
            lists = content.items() if isinstance(content, dict) else ()
            columns = {name: values for name, values in lists if isinstance(values, list) and len(values) > 1}
            if not columns:
                raise InputError(source.path, "found no samples", allowed)
            require_columns(source.path, len(columns))
            tables = [pa.table({name: _column(values)}) for name, values in columns.items()]  # each of its own length
            texts = (values for values in columns.values() if all(isinstance(one, str) for one in values))
            names = {len(values): values for values in texts}
    require_expansion(source.path, sum(table.nbytes for table in tables), len(source.content) * WIDTH)
    channels = (channel for table in tables for channel in channels_of_table(table, source.path, lists=names))
    return Recording(tuple(channels), JSON_LOG.format, source.path)


def _column(values: list) -> pa.Array:
    """A column of JSON; of texts where Arrow has no type for the values."""
    try:
        return pa.array(values)
    except (pa.ArrowException, OverflowError):
        return pa.array([str(value) for value in values])


JSON_LOG = FileFormat("JSON log", (".jsonl", ".ndjson", ".json"), _recognises, _read)


_FULL_LOAD = 885.0
_LARGEST_LOAD = 65535
_KEYS = ("timestamp", "position", "speed", "load", "input_volts", "temp", "goal_position")


def _is_bam(source: Source) -> bool:
    head = source.head.lstrip()
    return head.startswith("{") and '"entries"' in head and '"input_volts"' in head


def _read_bam(source: Source) -> Recording:
    content = parse_json(source.text(), source.path)
    entries = content.get("entries") if isinstance(content, dict) else None
    if not isinstance(entries, list) or not entries:
        raise InputError(f"{source.path}: entries", "found none", "allowed: a list of samples")
    raw = {key: _numbers(entries, key, source.path) for key in _KEYS}
    if not np.abs(raw["load"]).max() <= _LARGEST_LOAD:  # nor nan
        sample = int(np.abs(raw["load"]).argmax())
        place = f"{source.path}: entries[{sample}].load"
        raise InputError(place, f"found {raw['load'][sample]:g}", "allowed: a number of 16 bits")
    load = raw["load"].astype(np.int64).astype(np.uint16).view(np.int16)
    columns = {
        "position": ("rad", raw["position"]),
        "velocity": ("rad/s", raw["speed"]),
        "voltage": ("V", load / _FULL_LOAD * raw["input_volts"]),
        "temperature": ("degC", raw["temp"]),
        "position_reference": ("rad", raw["goal_position"]),
    }
    time = Channel("time", "s", raw["timestamp"], source.path)
    channels = tuple(Channel(name, *column, source.path, time=time) for name, column in columns.items())
    metadata = {key: str(value) for key, value in content.items() if isinstance(value, str | int | float)}
    off = sum(entry.get("torque_enable") is False for entry in entries)
    notes = (f"the motor is switched off in {off} of {len(entries)} samples",) if off else ()
    return Recording(channels, BAM.format, source.path, metadata, notes)


BAM = FileFormat("BAM servo JSON", (".json",), _is_bam, _read_bam)


def _numbers(entries: list, key: str, path: str) -> Array:
    values = [entry.get(key) if isinstance(entry, dict) else None for entry in entries]
    for sample, value in enumerate(values):
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if not number or (isinstance(value, int) and abs(value) > sys.float_info.max):
            raise InputError(f"{path}: entries[{sample}].{key}", f"found {short(repr(value))}", "allowed: a number")
    return np.array(values, dtype=np.float64)
