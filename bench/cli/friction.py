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
    refusal_as_json,
    tell,
    write_json,
    write_page,
    write_picture,
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
    from bench.report.friction import SCHEMA, friction_json
    from bench.report.friction import friction as document_of
    from bench.rig.rig import load_rig
    from bench.trace.read import read

    axis = load_rig(rig).on_axis(axis_name)
    with refusal_as_json(json, SCHEMA):
        found = friction_map([read(trace, axis.trace) for trace in traces], axis)
    document = document_of(found, axis.name)
    write_picture(out, document.pictures[0])
    write_page(report, document)
    if json is not None:
        write_json(json, friction_json(found))
    tell(document, [out, report], json)
