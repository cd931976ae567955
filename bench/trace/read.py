"""Read a recording of an axis from a file of any known format."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from bench.trace.channel import Recording
from bench.trace.readers.catalogue import reader_of
from bench.trace.reading_options import ReadingOptions
from bench.trace.source import open_source
from bench.trace.trace import Trace, assemble


def read(path: str | Path, columns: Mapping[str, str] | ReadingOptions | None = None) -> Trace:
    """Trace of a file: signals in SI units on one regular time base.

    Args:
        path: file of any format in `bench.trace.readers`, told by its content first and its ending second.
        columns: signal -> column name with unit, as in a rig's `[trace.columns]`, see `assemble`; or all that
            a rig's `[trace]` tells, as `rig.trace`.

    Raises:
        InputError: anything about the file that keeps it from being a trace; names file, line or column.
    """
    return assemble(read_recording(path), columns)


def read_recording(path: str | Path) -> Recording:
    """Channels of a file as they stand in it, before any mapping to signals.

    Raises:
        InputError: no such file, an unknown format, or a damaged one.
    """
    source = open_source(path)
    return reader_of(source).read(source)
