"""What readers of containers share: libraries that are extras, damage, what libraries say, compressed blocks."""

from __future__ import annotations

import importlib
import logging
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from typing import Any

from bench.errors import InputError

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
    """A module of a library that reads a container.

    Raises:
        InputError: it is not installed; says how to install it.
    """
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
    """Within the block what a library raises says that the file is damaged; most raise many kinds of errors."""
    try:
        yield
    except InputError:
        raise
    except kinds as error:
        reason = next(iter(str(error).splitlines()), "") or type(error).__name__
        found = f"the {container} file is truncated or damaged ({reason})"
        raise InputError(path, found, f"allowed: a complete {container} file") from error


class _Kept(logging.Handler):
    """Keeps messages, each once and in one line."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.messages: dict[str, None] = {}

    def emit(self, record: logging.LogRecord) -> None:
        self.messages[" ".join(record.getMessage().split())] = None


@contextmanager
def warnings_of(name: str) -> Iterator[dict[str, None]]:
    """What a library's loggers have to say within the block, as the dictionary's keys, instead of on standard error."""
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
    """Content of a block that declares `size` bytes, compressed for itself.

    Raises:
        ValueError: it holds more, or is packed in a way that is not known.
    """
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
        raise ValueError(f"a block holds more than the {size} bytes it declares")
    return content
