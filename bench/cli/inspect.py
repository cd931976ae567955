"""`bench inspect`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.console import AxisOption, JsonOption, console, tell_files, write_json


def inspect(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: Annotated[Path | None, typer.Option("--rig", help="Rig file whose [trace] says how to read it.")] = None,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Picture of every signal: .png, .pdf or .svg.")] = None,
    draft: Annotated[Path | None, typer.Option("--draft", help="Rig file to write, as far as the file tells.")] = None,
    motor: Annotated[str | None, typer.Option("--motor", help="For --draft: a motor of the catalogue.")] = None,
    axis_name: AxisOption = None,
) -> None:
    """Say what a recording holds: every column, what it is likely to be, rate, holes, signals with their range."""
    from bench.report.inspection import table
    from bench.rig.rig import load_rig
    from bench.trace.how import How
    from bench.trace.inspect import inspect_recording, to_json
    from bench.trace.read import read_recording

    how = load_rig(rig).on_axis(axis_name).trace if rig else How(axis=axis_name)
    recording = read_recording(trace)
    found = inspect_recording(recording, how)
    files = [path for path in (out, draft) if path is not None]
    if draft is not None:
        from bench.files import write_text
        from bench.rig.draft import draft as drafted

        write_text(draft, drafted(found, motor, axis_name))
    if out is not None:
        from bench.report.signals import draw_signals  # matplotlib: 0.35 s

        draw_signals(recording, how, out)
    if json is not None:
        write_json(json, to_json(found))
    if json != Path("-"):
        console().print(table(found))
        tell_files(files)
