"""Limits on the size of a file's content, as stored and decompressed.

A gzip expands to up to a thousand times its size, a Parquet file of one repeated value or a zip far more; a few
megabytes would fill the memory of any machine. Whatever expands is checked here before, or while, it does.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from gzip import GzipFile
from typing import IO

from bench.errors import InputError

_SIZE = re.compile(r"(\d{1,15}(?:\.\d{1,6})?)\s*(|k|M|G|T)i?B?", re.IGNORECASE)
_POWERS = {"": 0, "k": 1, "m": 2, "g": 3, "t": 4}


@dataclass(frozen=True)
class Bounds:
    """Limits on the content of one file.

    Attributes:
        size: bytes.
        ratio: content over file, where the content is above `small`; recordings of sensors compress 2 to 30 times.
        small: bytes that any file may expand to.
    """

    size: float = 2.0 * 1024**3
    ratio: float = 100.0
    small: float = 64.0 * 1024**2

    def most(self, stored: int) -> int:
        """Bytes that a file of `stored` bytes may expand to."""
        return int(min(self.size, max(self.ratio * stored, self.small)))


_PRESET = Bounds()
_BOUNDS: ContextVar[Bounds] = ContextVar("bounds", default=_PRESET)
#: Bytes that are taken at a time out of what expands.
_PIECE = 1 << 22
#: Columns, data sets or channels of a recording; a logger of a whole plant has fewer.
MOST_COLUMNS = 4096
#: How a user raises them.
RAISE = "`--max-size 16GB` raises the bound for a file that you trust"


@contextmanager
def bounded(size: str | None) -> Iterator[None]:
    """Within the block files may have and expand to `size`, e.g. `8 GB`, at any ratio; None changes nothing."""
    if size is None:
        yield
        return
    match = _SIZE.fullmatch(size.strip())
    if match is None:
        raise InputError("--max-size", f"found {size!r}", "allowed: a number of bytes, e.g. 8GB")
    with within(Bounds(float(match[1]) * 1024 ** _POWERS[match[2].lower()], float("inf"))):
        yield


@contextmanager
def within(given: Bounds) -> Iterator[None]:
    """Apply these limits within the block, e.g. those of the process that requested the work."""
    token = _BOUNDS.set(given)
    try:
        yield
    finally:
        _BOUNDS.reset(token)


def bounds() -> Bounds:
    """The limits in force."""
    return _BOUNDS.get()


def require_size(where: object, size: float) -> None:
    """Raise InputError naming `where` if `size` bytes are too many."""
    if size > bounds().size:
        raise InputError(where, f"found {shown(size)}", f"allowed: at most {shown(bounds().size)}; {RAISE}")


def require_expansion(where: object, size: float, stored: int) -> None:
    """Raise InputError naming `where` if a file of `stored` bytes must not expand to `size`."""
    if size > bounds().most(stored):
        raise too_much(where, stored, shown(size))


def require_columns(where: object, count: int) -> None:
    """Raise InputError naming `where` if `count` columns are too many: the time of some readers grows by its square."""
    if count > MOST_COLUMNS:
        raise InputError(where, f"found {count} columns or more", f"allowed: {MOST_COLUMNS}; export fewer signals")


def require_ratio(where: object, size: float, stored: int) -> None:
    """The same of what is read a piece at a time, and may be as long as it likes."""
    if size > max(bounds().ratio * stored, bounds().small):
        found = f"expands to {shown(size)} out of {shown(stored)}"
        raise InputError(where, found, f"allowed: {bounds().ratio:g} times its size; {RAISE}")


def read_bounded(expanding: IO[bytes] | GzipFile, where: object, stored: int) -> bytes:
    """All that comes out of what expands `stored` bytes, a piece at a time; InputError where it is too much."""
    most, pieces, size = bounds().most(stored), [], 0
    while piece := expanding.read(_PIECE):
        size += len(piece)
        if size > most:
            raise too_much(where, stored, f"more than {shown(most)}")
        pieces.append(piece)
    return b"".join(pieces)


def too_much(where: object, stored: int, found: str) -> InputError:
    """The error of a file of `stored` bytes that expands beyond its limit."""
    allowed = f"allowed: at most {shown(bounds().most(stored))} out of {shown(stored)}; {RAISE}"
    return InputError(where, f"expands to {found}", allowed)


def shown(size: float) -> str:
    """`1.5 GB`."""
    for unit in ("bytes", "kB", "MB"):
        if size < 1024:
            return f"{size:.3g} {unit}"
        size /= 1024
    return f"{size:.3g} GB"
