"""The catalogue of readers: those of the bench, and those that other packages offer.

Another package offers readers as entry points of the group `servobench.readers`, each an object with what `Reader`
tells:

    [project.entry-points."servobench.readers"]
    flight_recorder = "their_package.flight_recorder:READER"
"""

from __future__ import annotations

from functools import cache
from importlib.metadata import entry_points
from typing import Protocol, runtime_checkable

from bench.errors import InputError
from bench.trace.channel import Recording
from bench.trace.readers.bam import Bam
from bench.trace.readers.codesys import CodesysCsv, CodesysText, CodesysXml
from bench.trace.readers.epos import Epos
from bench.trace.readers.hdf5 import Hdf5
from bench.trace.readers.mat import Mat
from bench.trace.readers.mcap import Mcap
from bench.trace.readers.mdf import Mdf
from bench.trace.readers.npz import Npz
from bench.trace.readers.parquet import Parquet
from bench.trace.readers.sinumerik import Sinumerik
from bench.trace.readers.table import TextTable
from bench.trace.readers.tdms import Tdms
from bench.trace.readers.twincat import TwinCat
from bench.trace.source import Source

GROUP = "servobench.readers"


@runtime_checkable
class Reader(Protocol):
    """Reads one format: whatever stands in a file, as named columns with their units, and no meaning given to any."""

    @property
    def format(self) -> str:
        """The format in words, for messages."""
        ...

    @property
    def endings(self) -> tuple[str, ...]:
        """Of file names, in lower case, e.g. `(".mat",)`: they count where no content tells."""
        ...

    def recognises(self, source: Source) -> bool:
        """Whether the content is of this format; looks at its beginning alone, and raises nothing."""
        ...

    def read(self, source: Source) -> Recording:
        """Channels of the content.

        Raises:
            InputError: truncated, damaged, or without samples; names file, line or column.
        """
        ...


#: The surest to tell first. The plain table is asked last: many a format looks like one.
OWN: tuple[Reader, ...] = (
    Parquet(),
    Mat(),
    Hdf5(),
    Npz(),
    Tdms(),
    Mcap(),
    Mdf(),
    CodesysXml(),
    Sinumerik(),
    CodesysCsv(),
    CodesysText(),
    TwinCat(),
    Epos(),
    Bam(),
)
TABLE = TextTable()


@cache
def readers() -> tuple[Reader, ...]:
    """All readers, in the order in which they are asked: the bench's, those of other packages, the plain table.

    Raises:
        InputError: what another package offers is no reader.
    """
    offered = []
    for entry in entry_points(group=GROUP):
        reader = entry.load()
        if not isinstance(reader, Reader):
            raise InputError(f"{GROUP}: {entry.value}", f"found {reader!r}", "allowed: a reader of the bench")
        offered.append(reader)
    return (*OWN, *offered, TABLE)


def reader_of(source: Source) -> Reader:
    """The reader whose format the content shows; failing that, the one that the file's ending names.

    Raises:
        InputError: neither tells.
    """
    for reader in readers():
        if reader.recognises(source):
            return reader
    marked_up = source.head.lstrip().startswith(("<", "{"))
    for reader in readers() if "\0" not in source.head else ():
        if source.ending in reader.endings and not (reader is TABLE and marked_up):
            return reader
    formats = ", ".join(reader.format for reader in readers())
    raise InputError(source.path, "not a trace in any format the bench reads", f"allowed: {formats}")
