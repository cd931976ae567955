"""What other packages offer the bench as entry points: effects, readers and commands."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from importlib.metadata import EntryPoints, entry_points
from traceback import walk_tb
from types import TracebackType
from typing import TypeVar

from bench.errors import InputError, Stopped
from bench.names import short

T = TypeVar("T")
#: Groups of entry points.
GROUPS = EFFECTS_GROUP, READERS_GROUP, COMMANDS_GROUP = (
    "servobench.effects",
    "servobench.readers",
    "servobench.commands",
)


@cache
def _entry_points(_path: tuple[str, ...]) -> dict[str, EntryPoints]:
    """Entry points of each group from packages on this path, read once per process: that costs 7 ms."""
    installed = entry_points()
    return {group: installed.select(group=group) for group in GROUPS}


def offered(group: str, kind: type[T], what: str) -> Iterator[tuple[str, T]]:
    """Everything of a group, under the name that it is offered by.

    Args:
        group: of the entry points.
        kind: what each of them is.
        what: kind in words.

    Raises:
        InputError: one of them cannot be imported, or is something else; names its package.
    """
    for entry in _entry_points((*sys.path,))[group]:
        package = entry.dist.name if entry.dist else entry.module
        place = f"{group}: {entry.value} of {package}"
        try:
            found = entry.load()
        except (KeyboardInterrupt, Stopped):
            raise
        except BaseException as fault:  # whatever an import raises, SystemExit among it, which would end the run with 0
            said = short(f"{type(fault).__name__}: {fault}")
            remedy = f"update that package, or remove it: pip uninstall {package}"
            raise InputError(place, f"cannot be imported ({said})", remedy) from fault
        if not isinstance(found, kind):
            raise InputError(place, f"found {short(repr(found))}", f"allowed: {what}")
        yield entry.name, found


def at_fault(trace: TracebackType | None) -> str:
    """The package that offers what an exception passed through; empty if none of them does."""
    passed = {str(frame.f_globals.get("__name__")).split(".")[0] for frame, _ in walk_tb(trace)}
    others = (entry for group in GROUPS for entry in _entry_points((*sys.path,))[group])
    return next((entry.dist.name for entry in others if entry.dist and entry.module.split(".")[0] in passed), "")
