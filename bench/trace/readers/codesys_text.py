"""Reader of the text export of CODESYS and Machine Expert traces.

A title and the project's path, then `Timestamp(ms) VarA VarB` (German `Zeitstempel(ms)`) and lines of numbers.
"""

from __future__ import annotations

import re

from bench.errors import InputError
from bench.names import short
from bench.trace.channel import Channel, Recording, float_values
from bench.trace.readers.lab_units import LAB_UNITS
from bench.trace.source import Source

FORMAT = "CODESYS / Machine Expert text export"
ENDINGS = ()

_HEADER = re.compile(r"^[ \t]*(Timestamp|Zeitstempel)[ \t]*\((ms|us|µs)\)[ \t]+\S.*$", re.MULTILINE)


def recognises(source: Source) -> bool:
    """Whether a line of the head names a time stamp with its unit, then variables."""
    return _HEADER.search(source.head) is not None


def read(source: Source) -> Recording:
    """Recording of a text export; decimal commas are read as points.

    Raises:
        InputError: no samples, a line with too few or too many values, or text in a number.
    """
    text = source.text()
    header = _HEADER.search(text)
    assert header is not None
    names = header[0].replace(header[1], "", 1).split(")", 1)[1].split()
    before = text[: header.start()].splitlines()
    first = len(before) + 2
    rows = []
    for line, content in enumerate(text[header.end() :].splitlines()[1:], first):
        cells = content.replace(",", ".").split()
        if cells and len(cells) != len(names) + 1:
            raise InputError(
                f"{source.path}: line {line}",
                f"found {len(cells)} values",
                f"allowed: {len(names) + 1}, as the header has",
            )
        if cells:
            rows.append(cells)
    if not rows:
        raise InputError(source.path, "found a header and no samples", "allowed: at least two samples")
    columns = []
    for name, texts in zip(("time", *names), zip(*rows, strict=True), strict=True):
        place = f"{source.path}: column '{short(name)}'"
        columns.append(float_values(texts, lambda sample, place=place: f"{place}, line {first + sample}"))
    time = Channel("time", header[2], columns[0], source.path, line=first)
    channels = tuple(
        Channel(name, None, values, source.path, time=time, line=first)
        for name, values in zip(names, columns[1:], strict=True)
    )
    titles = [line.strip() for line in before if line.strip()]
    metadata: dict[str, str] = dict(zip(["title", "project"], titles, strict=False))
    return Recording(channels, FORMAT, source.path, metadata, usual_units=LAB_UNITS)
