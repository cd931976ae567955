"""Reader of the CSV export of CODESYS and Machine Expert traces.

A header of `key; value` lines (`Flags` 16: times in ms, 32: us), then per variable `N.Variable; name`, further keys,
`N.Data;` and lines `; time; value`.
"""

from __future__ import annotations

import re

from bench.errors import InputError
from bench.trace.channel import Channel, Recording, float_values, with_shared_times
from bench.trace.readers.lab_units import LAB_UNITS
from bench.trace.source import Source

FORMAT = "CODESYS / Machine Expert CSV export"
ENDINGS = ()

_MICROSECONDS = 32
_FLAGS = re.compile(r"[0-9]{1,19}")
_VARIABLE = re.compile(r"(\d+)\.Variable")


def recognises(source: Source) -> bool:
    """Whether the head is that of the export."""
    return source.head.lstrip().startswith("[key]") or bool(re.search(r"^\d+\.Variable;", source.head, re.MULTILINE))


def read(source: Source) -> Recording:
    """Recording of an export.

    Raises:
        InputError: no variable with data, or a line that is neither `key; value` nor `; time; value`.
    """
    keys: dict[str, str] = {}
    samples: dict[str, list[tuple[str, str]]] = {}
    lines: dict[str, int] = {}
    number = ""
    for line, text in enumerate(source.text().splitlines(), 1):
        cells = [cell.strip() for cell in text.split(";")]
        if not any(cells):
            continue
        if cells[0]:
            keys[cells[0]] = cells[1] if len(cells) > 1 else ""
            number = cells[0].removesuffix(".Data") if cells[0].endswith(".Data") else ""
            continue
        if len(cells) != 3 or not number:
            raise InputError(f"{source.path}: line {line}", f"found {text.strip()!r}", "allowed: '; time; value'")
        lines.setdefault(number, line)
        samples.setdefault(number, []).append((cells[1].replace(",", "."), cells[2].replace(",", ".")))
    channels = [_channel(keys, key, samples[key], lines[key], source.path) for key in samples]
    if not channels:
        raise InputError(source.path, "found no variable with data", "allowed: an export with recorded data")
    metadata = {key: keys[key] for key in ("Name", "ApplicationName", "IecTaskName", "Comment") if keys.get(key)}
    return Recording(with_shared_times(channels), FORMAT, source.path, metadata, usual_units=LAB_UNITS)


def _channel(keys: dict[str, str], number: str, pairs: list[tuple[str, str]], line: int, path: str) -> Channel:
    name = keys.get(f"{number}.Variable", f"variable {number}")
    flags = keys.get("Flags", "16")
    unit = "us" if _FLAGS.fullmatch(flags) and int(flags) & _MICROSECONDS else "ms"

    def place(sample: int) -> str:
        return f"{path}: line {line + sample}, variable '{name}'"

    times, values = (float_values(texts, place) for texts in zip(*pairs, strict=True))
    time = Channel(f"{name} time", unit, times, path, line=line)
    return Channel(name, None, values, path, time=time, line=line)
