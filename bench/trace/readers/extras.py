"""Libraries of containers, each an extra of the bench."""

from __future__ import annotations

import importlib
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from bench.errors import InputError


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


def damaged(path: str, container: str, error: Exception) -> InputError:
    """What to say about a container that its library cannot read."""
    reason = next(iter(str(error).splitlines()), "") or type(error).__name__
    return InputError(
        path, f"the {container} file is truncated or damaged ({reason})", f"allowed: a complete {container} file"
    )
