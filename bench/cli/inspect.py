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
    """Say what a recording holds: rate, jitter, holes, signals with their range and resolution, and every check."""
    from bench.checks.gate import gate
    from bench.report.checks import checks_json, checks_table
    from bench.rig.rig import load_rig
    from bench.trace.inspect import inspect as look
    from bench.trace.inspect import table, to_json
    from bench.trace.read import read

    axis = load_rig(rig) if rig else None
    columns = axis.trace.columns if axis else None
    found = look(trace, columns)
    checks = gate(read(trace, columns), axis).checks
    if json is not None:
        write_json(json, to_json(found, {"checks": checks_json(checks)}))
    else:
        console().print(table(found))
        console().print(checks_table(checks))
