"""Reader of maxon EPOS recorder files: `key:;value` lines, `;name;name`, `ms;rpm;%`, then samples.

Files that went through a spreadsheet carry commas at the end of their lines, and remarks such as `-800,,was -11.1`
where someone changed a value. A sample with a remark is no measurement: it is left out and reported.
"""

from __future__ import annotations

import re

from bench.arrays import Array
from bench.errors import InputError
from bench.names import short
from bench.trace.channel import Channel, Recording, float_values
from bench.trace.source import Source

FORMAT = "maxon EPOS recorder CSV"
ENDINGS = ()

_HEAD = re.compile(r"^(EPOS Studio Version|Sampling period|Recorded samples):;", re.MULTILINE)


def recognises(source: Source) -> bool:
    """Whether the head names a recorder's settings."""
    return _HEAD.search(source.head) is not None


def read(source: Source) -> Recording:
    """Recording of an EPOS file.

    Raises:
        InputError: no names, units or samples; a line with too few or too many values; text in a number.
    """
    lines = source.text().splitlines()
    head = next((number for number, line in enumerate(lines) if line.startswith(";")), None)
    if head is None or head + 2 >= len(lines):
        raise InputError(source.path, "found no line of names, units and samples", "allowed: a complete recording")
    names = [name.strip() for name in lines[head].rstrip(",").split(";")]
    units = [unit.strip() for unit in lines[head + 1].rstrip(",").split(";")]
    if len(names) != len(units):
        raise InputError(
            f"{source.path}: line {head + 2}", f"found {len(units)} units", f"allowed: {len(names)}, as there are names"
        )
    rows, numbers, notes = _rows(lines, head + 2, len(names), source.path)
    if not rows:
        raise InputError(source.path, "found a header and no samples", "allowed: at least two samples")
    columns = [
        _column(texts, numbers, name, source.path) for texts, name in zip(zip(*rows, strict=True), names, strict=True)
    ]
    line = numbers[0] if numbers[-1] - numbers[0] == len(numbers) - 1 else None
    time = Channel("time", units[0], columns[0], source.path, line=line)
    channels = tuple(
        Channel(name, unit, values, source.path, time=time, line=line)
        for name, unit, values in zip(names[1:], units[1:], columns[1:], strict=True)
    )
    return Recording(channels, FORMAT, source.path, _metadata(lines[:head]), tuple(notes))


def _rows(lines: list[str], first: int, width: int, path: str) -> tuple[list[list[str]], list[int], list[str]]:
    """Cells of each sample, its line number, and what was left out."""
    rows, numbers, notes = [], [], []
    for number, line in enumerate(lines[first:], first + 1):
        sample, _, remark = line.partition(",,")
        cells = [cell.strip() for cell in sample.rstrip(",").split(";")]
        if not any(cells):
            continue
        if remark.strip(" ,"):
            notes.append(f"line {number} left out: changed by hand ('{sample}', remark '{remark.strip(' ,')}')")
        elif len(cells) != width:
            raise InputError(
                f"{path}: line {number}", f"found {len(cells)} cell{'s' * (len(cells) > 1)}", f"allowed: {width}"
            )
        else:
            rows.append(cells)
            numbers.append(number)
    return rows, numbers, notes


def _column(texts: tuple[str, ...], numbers: list[int], name: str, path: str) -> Array:
    label = name or "time"
    decimal_point = [text.replace(",", ".") for text in texts]
    return float_values(decimal_point, lambda sample: f"{path}: line {numbers[sample]}, column '{short(label)}'")


def _metadata(lines: list[str]) -> dict[str, str]:
    keys = [line.rstrip(",").strip('"').split(":;", 1) for line in lines if ":;" in line]
    wanted = ("Date", "Firmware Version", "EPOS Studio Version", "Sampling period")
    return {key: value for key, value in keys if key in wanted}
