"""Calls of compiled functions, seen by the interpreter's own profiler."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def calls_of(*functions: Callable) -> Iterator[list[Callable]]:
    """Those of compiled functions that this thread calls, in their order."""
    called: list[Callable] = []

    def seen(_: FrameType, event: str, function: object) -> None:
        if event == "c_call":
            called.extend(one for one in functions if one is function)

    before = sys.getprofile()
    sys.setprofile(seen)
    try:
        yield called
    finally:
        sys.setprofile(before)
