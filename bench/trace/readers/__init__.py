"""Readers: one file per format. `READERS` lists them, the surest to tell first; the plain table comes last."""

from __future__ import annotations

from types import ModuleType

from bench.errors import InputError
from bench.trace.readers import (
    bam,
    codesys_csv,
    codesys_text,
    codesys_xml,
    epos,
    hdf5,
    mat,
    mcap,
    mdf,
    npz,
    parquet,
    sinumerik,
    table,
    tdms,
    twincat,
)
from bench.trace.source import Source

READERS: tuple[ModuleType, ...] = (
    parquet,
    mat,
    hdf5,
    npz,
    tdms,
    mcap,
    mdf,
    codesys_xml,
    sinumerik,
    codesys_csv,
    codesys_text,
    twincat,
    epos,
    bam,
    table,
)


def reader_of(source: Source) -> ModuleType:
    """The reader whose format the content shows; failing that, the one that the file's ending names.

    Raises:
        InputError: neither tells.
    """
    for reader in READERS:
        if reader.recognises(source):
            return reader
    marked_up = source.head.lstrip().startswith(("<", "{"))
    for reader in READERS if "\0" not in source.head else ():
        if source.ending in reader.ENDINGS and not (reader is table and marked_up):
            return reader
    formats = ", ".join(reader.FORMAT for reader in READERS)
    raise InputError(source.path, "not a trace in any format the bench reads", f"allowed: {formats}")
