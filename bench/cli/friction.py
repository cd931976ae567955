"""`bench friction`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import (
    AxisOption,
    JsonOption,
    ReportOption,
    RigOption,
    list_files,
    printed,
    refusal_as_json,
    warn,
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
        from bench.report.pages.friction import friction_page
        from bench.report.publish import write_html

        write_html(report, friction_page(found, axis.name))
    if json is not None:
        write_json(json, friction_json(found))
    if json != Path("-"):
        printed(friction_table(found, axis.name))
        list_files([path for path in (out, report) if path is not None])
    warn(warnings_of(found.checks))
