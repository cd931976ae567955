"""Libraries of containers, each an extra of the bench."""

from __future__ import annotations

import importlib
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


def damaged(path: str, container: str, error: Exception) -> InputError:
    """What to say about a container that its library cannot read."""
    reason = next(iter(str(error).splitlines()), "") or type(error).__name__
    return InputError(
        path, f"the {container} file is truncated or damaged ({reason})", f"allowed: a complete {container} file"
    )
