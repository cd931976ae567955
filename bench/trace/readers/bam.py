"""Reader of recordings of small servos by the BAM project: JSON with `entries` of position, speed, load and voltage.

`load` is the share of the supply that the bridge applies, as a signed 16-bit number with 885 for full; so the motor's
voltage is load/885 * input_volts (Robotis XL330 manual, present PWM; github.com/Rhoban/bam).
Scalars beside the entries (mass, length, kp, ...) become metadata.
"""

from __future__ import annotations

import sys

import numpy as np

from bench.arrays import Array
from bench.errors import InputError
from bench.names import short
from bench.structured import parse_json
from bench.trace.channel import Channel, Recording
from bench.trace.source import FileFormat, Source

_FULL_LOAD = 885.0
_LARGEST_LOAD = 65535
_KEYS = ("timestamp", "position", "speed", "load", "input_volts", "temp", "goal_position")


def _recognises(source: Source) -> bool:
    head = source.head.lstrip()
    return head.startswith("{") and '"entries"' in head and '"input_volts"' in head


def _read(source: Source) -> Recording:
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


BAM = FileFormat("BAM servo JSON", (".json",), _recognises, _read)


def _numbers(entries: list, key: str, path: str) -> Array:
    values = [entry.get(key) if isinstance(entry, dict) else None for entry in entries]
    for sample, value in enumerate(values):
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if not number or (isinstance(value, int) and abs(value) > sys.float_info.max):
            raise InputError(f"{path}: entries[{sample}].{key}", f"found {short(repr(value))}", "allowed: a number")
    return np.array(values, dtype=np.float64)
