"""`bench inspect`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import AxisOption, JsonOption, ReportOption, tell, write_json, write_page, write_picture


def inspect(
    file: Annotated[Path, typer.Argument(metavar="TRACE", help="Recording of any known format.")],
    rig: Annotated[Path | None, typer.Option("--rig", help="Rig file whose [trace] says how to read it.")] = None,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Picture of every signal: .png, .pdf or .svg.")] = None,
    draft: Annotated[Path | None, typer.Option("--draft", help="Rig file to write, as far as the file tells.")] = None,
    motor: Annotated[str | None, typer.Option("--motor", help="For --draft: a motor of the catalogue.")] = None,
    axis_name: AxisOption = None,
    report: ReportOption = None,
) -> None:
    """Say what a recording holds: every column, what it is likely to be, rate, holes, signals with their range."""
    from bench.gate.gate import gate
    from bench.report.inspection import inspection, signals_picture
    from bench.report.serial import as_json
    from bench.rig.rig import load_rig
    from bench.trace.inspect import inspect_recording, to_json
    from bench.trace.read import read_recording
    from bench.trace.reading_options import GivenOptions
    from bench.trace.trace import assemble

    axis = load_rig(rig).on_axis(axis_name) if rig else None
    how = axis.trace if axis is not None else GivenOptions(axis=axis_name)
    recording = read_recording(file)
    found = inspect_recording(recording, how)
    trace = None if found.asks is not None else assemble(recording, how)
    checks = () if trace is None else gate(trace, axis).checks
    document = inspection(found, checks, trace)
    if draft is not None:
        from bench.files import write_text
        from bench.rig.draft import draft as drafted

        write_text(draft, drafted(found, motor, axis_name))
    if out is not None:
        write_picture(out, signals_picture(recording, how))
    write_page(report, document)
    if json is not None:
        write_json(json, to_json(found, {"checks": as_json(checks)}))
    tell(document, [out, draft, report], json)
