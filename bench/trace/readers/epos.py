"""Reader of maxon EPOS recorder files: `key:;value` lines, `;name;name`, `ms;rpm;%`, then samples.

Files that went through a spreadsheet carry commas at the end of their lines, and remarks such as `-800,,was -11.1`
where someone changed a value. A sample with a remark is no measurement: it is left out and reported.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from bench.errors import InputError
from bench.trace.channel import Recording
from bench.trace.readers.table import read_timed
from bench.trace.source import FileFormat, Source, no_samples, shows

_HEAD = re.compile(r"^(EPOS Studio Version|Sampling period|Recorded samples):;", re.MULTILINE)
_KEPT = ("Date", "Firmware Version", "EPOS Studio Version", "Sampling period")


def _read(source: Source) -> Recording:
    lines = source.text().splitlines()
    head = next((number for number, line in enumerate(lines) if line.startswith(";")), None)
    if head is None or head + 2 >= len(lines):
        raise InputError(source.path, "found no line of names, units and samples", "allowed: a complete recording")
    names, units = ([cell.strip() for cell in line.rstrip(",").split(";")] for line in lines[head : head + 2])
    if len(names) != len(units):
        place = f"{source.path}: line {head + 2}"
        raise InputError(place, f"found {len(units)} units", f"allowed: {len(names)}, as there are names")
    samples, notes = _measured(lines[head + 2 :], head + 3)
    if not any(samples):
        raise no_samples(source)
    labels = [f"{name or 'time'} [{unit}]" for name, unit in zip(names, units, strict=True)]
    channels = read_timed(samples, head + 3, labels, ";", source.path)
    settings = (line.rstrip(",").strip('"').split(":;", 1) for line in lines[:head] if ":;" in line)
    metadata = {key: value for key, value in settings if key in _KEPT}
    return Recording(tuple(channels), EPOS.format, source.path, metadata, tuple(notes))


EPOS = FileFormat("maxon EPOS recorder CSV", (), shows(_HEAD), _read)


def _measured(lines: Iterable[str], first: int) -> tuple[list[str], list[str]]:
    """Each line as the recorder wrote it, empty where someone changed it; and what was left out."""
    measured, notes = [], []
    for number, line in enumerate(lines, first):
        sample, _, remark = line.partition(",,")
        changed = remark.strip(" ,")
        if changed and sample.strip(" ,;"):
            notes.append(f"line {number} left out: changed by hand ('{sample}', remark '{changed}')")
        measured.append("" if changed else sample.rstrip(","))
    return measured, notes
