"""A file to be read as a trace: its content, out of gzip if need be, its text whatever Unicode it is in, its format."""

from __future__ import annotations

import codecs
import gzip
import io
import re
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from bench.bounds import read_bounded
from bench.errors import InputError
from bench.files import marker, read_bytes
from bench.names import readable
from bench.trace.channel import Recording

_GZIP = b"\x1f\x8b"
#: Byte order marks, and how XML without one begins in UTF-16 (XML 1.0, appendix F).
_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
    (b"<\0?\0", "utf-16-le"),
    (b"\0<\0?", "utf-16-be"),
)
_HEAD = 65536


@dataclass(frozen=True)
class Source:
    """Content of a file.

    Attributes:
        path: of the file.
        content: its bytes; decompressed if the file is gzip, and UTF-8 if it begins with the byte order mark of
            another Unicode encoding.
        ending: of the file's name in lower case, without `.gz`.
    """

    path: str
    content: bytes
    ending: str

    @cached_property
    def head(self) -> str:
        """First 64 KiB as text, for distinguishing formats; undecodable bytes replaced."""
        return self.content[:_HEAD].decode("utf-8", errors="replace")

    def text(self) -> str:
        """The whole content as text."""
        return decode(self.content)


@dataclass(frozen=True)
class FileFormat:
    """A `bench.trace.read.Reader` of functions."""

    format: str
    endings: tuple[str, ...]
    recognises: Callable[[Source], bool]
    read: Callable[[Source], Recording]


def begins(*marks: bytes) -> Callable[[Source], bool]:
    """Whether a file begins with one of these bytes, as a function of it."""
    return lambda source: source.content.startswith(marks)


def shows(pattern: re.Pattern[str]) -> Callable[[Source], bool]:
    """Whether the head of a file contains a pattern, as a function of it."""
    return lambda source: pattern.search(source.head) is not None


def no_samples(source: Source) -> InputError:
    """The error of a text that ends with its header."""
    return InputError(source.path, "found a header and no samples", "allowed: at least two samples")


def decode(content: bytes) -> str:
    """Bytes as text: UTF-8, or what Windows writes in western Europe, a superset of Latin-1."""
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def utf8(content: bytes) -> bytes:
    """Text as UTF-8; the same bytes where it is UTF-8, but for a character that is cut off at the end."""
    if b"\n" not in content:
        content = content.replace(b"\r", b"\n")  # as old recorders on a Mac end lines
    if content.isascii():
        return content  # a long file is not decoded for nothing
    try:
        content.decode("utf-8")
    except UnicodeDecodeError as error:
        if error.start < len(content) - 3:
            return decode(content).encode()
    return content


def open_source(path: str | Path) -> Source:
    """Read a file, or of a folder that is one recording the file that describes it.

    Raises:
        InputError: not there, not a file, not readable, empty, or a damaged gzip.
    """
    path = marker(Path(path))
    return source_of(path, read_bytes(path, "a trace"))


def source_of(path: str | Path, content: bytes) -> Source:
    """Content of a file that was read already, under its name; InputError where it is empty or a damaged gzip."""
    name = str(path).lower()
    if content.startswith(_GZIP):
        try:
            with gzip.GzipFile(fileobj=io.BytesIO(content)) as packed:
                content = read_bounded(packed, path, len(content))
        except (EOFError, OSError, zlib.error) as error:
            found = f"the gzip is truncated or damaged ({error})"
            raise InputError(path, found, "allowed: a complete gzip") from error
    encoding = next((encoding for mark, encoding in _MARKS if content.startswith(mark)), None)
    if encoding is not None:
        try:
            content = content.decode(encoding).removeprefix("\ufeff").encode()
        except UnicodeDecodeError as error:
            found = f"the {encoding.upper()} text is truncated or damaged ({error.reason})"
            raise InputError(path, found, "allowed: whole text") from error
    if not content or content.isspace():
        raise InputError(path, "the file is empty", "allowed: a trace with a header and samples")
    return Source(readable(path), content, Path(name.removesuffix(".gz")).suffix)
