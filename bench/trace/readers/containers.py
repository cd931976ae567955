"""What readers of containers share: libraries that are extras, damage, compressed blocks, arrays under names."""

from __future__ import annotations

import importlib
import logging
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from typing import Any

import numpy as np

from bench.errors import InputError
from bench.trace.channel import Channel

#: Compressions by the bytes they begin with: zlib with its usual window, Zstandard, an LZ4 frame.
_ZLIB, _ZSTD, _LZ4 = b"\x78", b"\x28\xb5\x2f\xfd", b"\x04\x22\x4d\x18"
#: Signals that a matrix may hold, beside its samples.
MOST_SIGNALS = 1000


def library(module: str, package: str, extra: str, path: str, container: str) -> Any:  # noqa: ANN401
    """A module of a library that reads a container.

    Raises:
        InputError: it is not installed; says how to install it.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise InputError(
            path,
            f"{container} is read by {package}, which is not installed",
            f"install it: pip install 'servobench[{extra}]'",
        ) from error


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


def is_samples(value: object) -> bool:
    """Whether a value is an array of samples: numbers, moments or fields of them, in one or two dimensions."""
    if not isinstance(value, np.ndarray) or value.size < 2 or value.ndim > 2:
        return False
    return value.dtype.kind in "fiubmM" or (value.dtype.names is not None and value.ndim == 1)


def channels_of(name: str, value: np.ndarray, path: str, unit: str | None = None) -> Iterator[Channel]:
    """Channels of an array: `name`; of a matrix `name(:,1)` with a signal a column, `name(1,:)` with a signal a row.

    The longer side of a matrix is taken for its samples.
    """
    if value.dtype.names is not None:
        for field in value.dtype.names:
            if value[field].dtype.kind in "fiubmM" and value[field].ndim == 1:
                yield from channels_of(f"{name}.{field}" if name else field, value[field], path)
        return
    if value.ndim == 1 or 1 in value.shape:
        yield _channel(name, value.reshape(-1), path, unit)
        return
    by_rows = value.shape[0] < value.shape[1]
    signals = value if by_rows else value.T
    if signals.shape[0] > MOST_SIGNALS:
        return
    for number, signal in enumerate(signals, 1):
        yield _channel(f"{name}({number},:)" if by_rows else f"{name}(:,{number})", signal, path, unit)


def _channel(name: str, values: np.ndarray, path: str, unit: str | None) -> Channel:
    if values.dtype.kind in "mM":
        known = values[~np.isnat(values)]
        first = known[0] if known.size else values[0]
        passed = (values - first) / np.timedelta64(1, "ns") * 1e-9
        return Channel(name, "s", np.asarray(passed, dtype=np.float64), path, moments=True)
    return Channel(name, unit, np.ascontiguousarray(values, dtype=np.float64), path)
