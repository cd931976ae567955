"""What readers of containers share: libraries that are extras, damage, messages of libraries, compressed blocks."""

from __future__ import annotations

import importlib
import logging
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from io import BytesIO
from typing import Any

from bench.bounds import Bounds, bounds, within
from bench.errors import InputError
from bench.jobs.process import Failure, Limits, WorkerProcess, watched
from bench.trace.channel import Recording
from bench.trace.source import Source

#: Compressions by the bytes they begin with: zlib with its usual window, Zstandard, an LZ4 frame.
_ZLIB, _ZSTD, _LZ4 = b"\x78", b"\x28\xb5\x2f\xfd", b"\x04\x22\x4d\x18"
#: Package and extra of servobench by which a module is installed.
_EXTRAS = {
    "asammdf": ("asammdf", "mdf"),
    "h5py": ("h5py", "hdf5"),
    "mcap": ("mcap", "mcap"),
    "mcap_ros2": ("mcap-ros2-support", "mcap"),
    "rosbags": ("rosbags", "ros"),
    "nptdms": ("npTDMS", "tdms"),
}


def library(module: str, path: str, container: str) -> Any:  # noqa: ANN401
    """A module of a library that reads a container; InputError with how to install it where it is not there."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        package, extra = _EXTRAS[module.partition(".")[0]]
        found = f"{container} is read by {package}, which is not installed"
        raise InputError(path, found, f"install it: pip install 'servobench[{extra}]'") from error


@contextmanager
def reading(
    path: str, container: str, kinds: type[Exception] | tuple[type[Exception], ...] = Exception
) -> Iterator[None]:
    """Within the block any error of a library means that the file is damaged; most raise many kinds of errors."""
    try:
        yield
    except InputError:
        raise
    except kinds as error:
        reason = next(iter(str(error).splitlines()), "") or type(error).__name__
        found = f"the {container} file is truncated or damaged ({reason})"
        raise InputError(path, found, f"allowed: a complete {container} file") from error


#: Of a library that may hang - s -, as a recording of gigabytes takes minutes; its memory - bytes -, and the times that
#: it may hold what the file may expand to.
_DEADLINE, _ITSELF, _TIMES = 900.0, 1 << 30, 4


def apart(read: Callable[[Source], Recording]) -> Callable[[Source], Recording]:
    """A reader whose library a damaged file can end with all of its process, in a process of its own (0.4 s)."""

    def asked(source: Source) -> Recording:
        if watched():
            return read(source)
        limits = Limits(_DEADLINE, _ITSELF + _TIMES * bounds().most(len(source.content)))
        with WorkerProcess(partial(_told, read), limits) as process:
            found = process.do((source, bounds()))
        if isinstance(found, Failure):
            said = f"the file is truncated or damaged (what reads it: {found.reason})"
            raise InputError(source.path, said, "allowed: a complete file")
        if isinstance(found, Recording):
            return found
        raise InputError(*found)

    return asked


def _told(read: Callable[[Source], Recording], item: tuple[Source, Bounds]) -> Recording | tuple[str, str, str]:
    """A recording, or place, fault and advice of its refusal, which no exception carries from process to process."""
    source, limits = item
    try:
        with within(limits):
            return read(source)
    except InputError as error:
        return error.where, error.found, error.allowed


class _Kept(logging.Handler):
    """Keeps messages, each once and in one line."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.messages: dict[str, None] = {}

    def emit(self, record: logging.LogRecord) -> None:
        self.messages[" ".join(record.getMessage().split())] = None


@contextmanager
def warnings_of(name: str) -> Iterator[dict[str, None]]:
    """The messages of a library's loggers within the block, as the dictionary's keys, instead of on standard error."""
    known = logging.Logger.manager.loggerDict
    loggers = [logging.getLogger(one) for one in known if one == name or one.startswith(f"{name}.")]
    before, kept = [(logger.handlers, logger.propagate) for logger in loggers], _Kept()
    for logger in loggers:
        logger.handlers, logger.propagate = [kept], False
    try:
        yield kept.messages
    finally:
        for logger, (handlers, propagate) in zip(loggers, before, strict=True):
            logger.handlers, logger.propagate = handlers, propagate


def unpack(packed: bytes, size: int) -> bytes:
    """Content of a packed block that declares `size` bytes; ValueError if it contains more, or its packing is
    unknown."""
    if packed.startswith(_ZLIB):
        content = zlib.decompressobj().decompress(packed, size + 1)
    elif packed.startswith(_ZSTD):
        decompressor = importlib.import_module("zstandard").ZstdDecompressor()
        content = decompressor.stream_reader(packed, read_across_frames=True).read(size + 1)
    elif packed.startswith(_LZ4):
        content = importlib.import_module("lz4.frame").LZ4FrameFile(BytesIO(packed)).read(size + 1)
    else:
        raise ValueError(f"a block is packed in an unknown way (0x{packed[:4].hex()})")
    if len(content) > size:
        raise ValueError(f"a block contains more than the {size} bytes it declares")
    return content
