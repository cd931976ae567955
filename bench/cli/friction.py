"""`bench friction`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.console import (
    AxisOption,
    JsonOption,
    ReportOption,
    RigOption,
    console,
    print_files,
    print_warnings,
    refusal_as_json,
    write_json,
)


def friction(
    traces: Annotated[list[Path], typer.Argument(metavar="TRACE...", help="Recordings, each at one steady speed.")],
    rig: RigOption,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Figure to write: .png, .pdf or .svg.")] = None,
    axis_name: AxisOption = None,
    report: ReportOption = None,
) -> None:
    """Tell friction over speed from recordings at one speed each, and name the effect that bends it."""
    from bench.friction_map.map import friction_map
    from bench.gate.gate import warnings_of
    from bench.report.friction import SCHEMA, draw_friction, friction_json, friction_table
    from bench.rig.rig import load_rig
    from bench.trace.read import read

    axis = load_rig(rig).on_axis(axis_name)
    with refusal_as_json(json, SCHEMA):
        found = friction_map([read(trace, axis.trace) for trace in traces], axis)
    if out is not None:
        draw_friction(found, axis.name, out)
    if report is not None:
        from bench.report.page.folder import write_html
        from bench.report.pages.friction import friction_page

        write_html(report, friction_page(found, axis.name))
    if json is not None:
        write_json(json, friction_json(found))
    if json != Path("-"):
        console().print(friction_table(found, axis.name))
        print_files([path for path in (out, report) if path is not None])
    print_warnings(warnings_of(found.checks))
