"""`bench inspect`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.console import JsonOption, console, write_json


def inspect(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: Annotated[Path | None, typer.Option("--rig", help="Rig file whose [trace.columns] names the signals.")] = None,
    json: JsonOption = None,
) -> None:
    """Say what a recording holds: rate, jitter, holes, signals with their range and resolution."""
    from bench.rig.rig import load_rig
    from bench.trace.inspect import inspect as look
    from bench.trace.inspect import table, to_json

    found = look(trace, load_rig(rig).trace.columns if rig else None)
    if json is not None:
        write_json(json, to_json(found))
    else:
        console().print(table(found))
