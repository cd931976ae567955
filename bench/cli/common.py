"""What every command does around its work: inputs are kept, files are bounded; and options that all take."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, get_type_hints

import typer

from bench.bounds import bounded
from bench.errors import InputError
from bench.files import keeping, require_writable

#: Parameters of commands that name what is written, files or folders; every other path is read.
WRITTEN = frozenset({"out", "json", "junit", "draft", "synthetic", "notebooks", "report", "script", "video"})
#: Parameters of commands whose file is read, and replaced where that is asked for.
REPLACED = frozenset({"baseline"})

DebugOption = Annotated[bool, typer.Option("--debug", help="Print the whole traceback of a failure.")]
SizeOption = Annotated[
    str | None, typer.Option("--max-size", help="Bytes a file may have or expand to, e.g. 8GB (preset: 2 GB).")
]


def guarded(verb: Callable[..., None]) -> Callable[..., None]:
    """A command that takes `--debug` and `--max-size` too, and whose outputs replace none of its inputs.

    Raises:
        InputError: before any work, where an output is an input or `--json` names a folder that is not there.
    """
    signature, hints = inspect.signature(verb), get_type_hints(verb, include_extras=True)
    own = [p.replace(annotation=hints[p.name], kind=p.KEYWORD_ONLY) for p in signature.parameters.values()]
    added = {"max_size": (SizeOption, None), "debug": (DebugOption, False)}
    more = [
        inspect.Parameter(n, inspect.Parameter.KEYWORD_ONLY, default=d, annotation=a) for n, (a, d) in added.items()
    ]

    @functools.wraps(verb)
    def command(max_size: str | None, debug: bool, **given: object) -> None:  # `debug` is `bench.cli.main`'s
        with bounded(max_size), keeping(_paths(given, read=True)):
            _require_places(given)
            verb(**given)

    vars(command)["__signature__"] = inspect.Signature([*own, *more])
    command.__annotations__ = {p.name: p.annotation for p in (*own, *more)}
    return command


def _paths(given: Mapping[str, object], read: bool) -> Iterator[Path]:
    """Paths among a command's arguments that are read, or written."""
    for name, value in given.items():
        if name not in REPLACED and (name in WRITTEN) is not read:
            yield from (path for path in (value if isinstance(value, list) else [value]) if isinstance(path, Path))


def _require_places(given: Mapping[str, object]) -> None:
    for path in _paths(given, read=False):
        if path != Path("-") and not path.is_dir():
            require_writable(path)
    json, out = given.get("json"), given.get("out")
    if isinstance(json, Path) and json != Path("-") and not json.parent.is_dir() and json.parent != out:
        raise InputError(json, f"found no folder '{json.parent}'", "allowed: a file in a folder that is there")
