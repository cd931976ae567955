"""Read a recording of an axis from a file of any known format, by the bench's readers and those of other packages.

Another package offers readers as entry points of the group `servobench.readers`, each an object with what `Reader`
requires:

    [project.entry-points."servobench.readers"]
    flight_recorder = "their_package.flight_recorder:READER"
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Protocol, runtime_checkable

from bench.errors import InputError
from bench.names import with_known_arguments
from bench.offered import READERS_GROUP, offered
from bench.trace.channel import Recording, with_stamps, with_units
from bench.trace.choose import ReadingOptions
from bench.trace.joints import by_joints
from bench.trace.readers.arrow import PARQUET
from bench.trace.readers.codesys import CODESYS_CSV, CODESYS_TEXT, CODESYS_XML, SINUMERIK
from bench.trace.readers.epos import EPOS
from bench.trace.readers.json_log import BAM, JSON_LOG
from bench.trace.readers.lerobot import LEROBOT
from bench.trace.readers.mcap import BAG, MCAP
from bench.trace.readers.measurement import MDF, TDMS
from bench.trace.readers.named_arrays import HDF5, MAT, NUMPY
from bench.trace.readers.table import TABLE
from bench.trace.readers.twincat import TWINCAT
from bench.trace.source import Source, open_source
from bench.trace.trace import Trace, assemble


@runtime_checkable
class Reader(Protocol):
    """Reads one format: any content of a file, as named columns with their units, and no meaning given to any."""

    @property
    def format(self) -> str:
        """The format in words, for messages."""
        ...

    @property
    def endings(self) -> tuple[str, ...]:
        """Of file names, in lower case, e.g. `(".mat",)`: they count where the content does not decide."""
        ...

    def recognises(self, source: Source, /) -> bool:
        """Whether the content is of this format; looks at its beginning alone, and raises nothing."""
        ...

    def read(self, source: Source, /) -> Recording:
        """Channels of the content.

        Raises:
            InputError: truncated, damaged, or without samples; names file, line or column.
        """
        ...


#: The surest to tell first. The plain table is tried last: many a format looks like one.
OWN: tuple[Reader, ...] = (
    *(LEROBOT, PARQUET, MAT, HDF5, NUMPY, TDMS, MCAP, MDF),
    *(CODESYS_XML, SINUMERIK, CODESYS_CSV, CODESYS_TEXT, TWINCAT, EPOS, BAM, BAG, JSON_LOG),
)


@cache
def readers() -> tuple[Reader, ...]:
    """All readers, in the order in which they are tried: the bench's, those of other packages, the plain table.

    Raises:
        InputError: what another package offers is no reader.
    """
    others = (
        reader for _, reader in offered(READERS_GROUP, Reader, "a reader with format, endings, recognises and read")
    )
    return (*OWN, *others, TABLE)


def reader_of(source: Source) -> Reader:
    """The reader whose format the content shows; failing that, the one that the file's ending names.

    Raises:
        InputError: neither decides.
    """
    for reader in readers():
        if reader.recognises(source):
            return reader
    marked_up = source.head.lstrip().startswith(("<", "{"))
    for reader in readers() if "\0" not in source.head else ():
        if source.ending in reader.endings and not (reader is TABLE and marked_up):
            return reader
    if source.ending == ".toml":
        allowed = "allowed: a recording; --rig and bench.load_rig take a rig"
        raise InputError(source.path, "found a TOML file", allowed)
    formats = ", ".join(reader.format for reader in readers())
    raise InputError(source.path, "not a trace in any format the bench reads", f"allowed: {formats}")


@with_known_arguments
def read(
    path: str | Path,
    columns: Mapping[str, str] | ReadingOptions | None = None,
    units: Mapping[str, str] | None = None,
) -> Trace:
    """Trace of a file: signals in SI units on one regular time base.

    Args:
        path: file of any format, recognised by its content first and its ending second.
        columns: signal -> column name with unit, as in a rig's `[trace.columns]`, see `assemble`; or all that
            a rig's `[trace]` contains, as `rig.trace`.
        units: units of columns by their names, which replace those of the file.

    Raises:
        InputError: anything about the file that keeps it from being a trace; names file, line or column.
    """
    return assemble(read_recording(path).stated(units), columns)


def read_recording(path: str | Path) -> Recording:
    """Channels of a file, or of a dataset's or a bag's folder, as they stand in it, before any mapping to signals.

    Those of joints have them as their axes. Raises as `open_source` and `Reader`.
    """
    source = open_source(path)
    recording = reader_of(source).read(source)
    return by_joints(replace(recording, channels=with_units(with_stamps(recording.channels))))
