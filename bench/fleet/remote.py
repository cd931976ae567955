"""Recordings in a storage that fsspec knows (s3://, gs://, https://, sftp://): their mark, and a copy to be read."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from fsspec.core import url_to_fs

from bench.bounds import require_size
from bench.errors import InputError

#: Bytes copied at a time.
_PIECE = 1 << 22


def marked(url: str) -> str:
    """What the storage calls this version of a file, without reading it: changes whenever the file does.

    Raises:
        InputError: no such file, or a storage that cannot be reached or is not known.
    """
    with _errors_as_input(url):
        storage, path = url_to_fs(url)
        return str(storage.ukey(path))


def fetched(url: str, folder: Path) -> Path:
    """A copy of a file in a folder, under its own name, which may tell its format.

    Raises:
        InputError: as `marked`, or it is too large.
    """
    copy, size = folder / (PurePosixPath(url).name or "trace"), 0
    with _errors_as_input(url):
        storage, path = url_to_fs(url)
        with storage.open(path, "rb") as remote, copy.open("wb") as local:
            while piece := remote.read(_PIECE):
                size += len(piece)
                require_size(url, size)
                local.write(piece)
    return copy


@contextmanager
def _errors_as_input(url: str) -> Iterator[None]:
    try:
        yield
    except (OSError, ValueError, ImportError) as error:  # no file or way to it; no such storage; no package for it
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(url, f"cannot be read ({reason})", "give the URL of a trace that fsspec can open") from error
