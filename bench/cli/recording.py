"""`bench inspect`, `friction` and `limits`: what recordings hold."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import bench
from bench.cli import common
from bench.cli.common import AxisOption, JsonOption, OptionalRigOption, ReportOption, RigOption
from bench.files import write_text


def inspect(
    file: Annotated[Path, typer.Argument(metavar="TRACE", help="Recording of any known format.")],
    rig: OptionalRigOption = None,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option(help="Picture of every signal: .png, .pdf or .svg.")] = None,
    draft: Annotated[Path | None, typer.Option(help="Rig file to write, as far as the file tells.")] = None,
    motor: Annotated[str | None, typer.Option(help="For --draft: a motor of the catalogue.")] = None,
    axis_name: AxisOption = None,
    report: ReportOption = None,
) -> None:
    """Say what a recording holds: every column, what it is likely to be, rate, holes, signals with their range."""
    from bench.gate.gate import gate
    from bench.report.inspection import inspection, signals_picture
    from bench.report.serial import as_json
    from bench.trace.choose import GivenOptions
    from bench.trace.inspect import inspect_recording, to_json
    from bench.trace.read import read_recording
    from bench.trace.trace import assemble

    axis = bench.load_rig(rig).on_axis(axis_name) if rig else None
    how = axis.trace if axis is not None else GivenOptions(axis=axis_name)
    recording = read_recording(file)
    found = inspect_recording(recording, how)
    trace = None if found.asks is not None else assemble(recording, how)
    checks = () if trace is None else gate(trace, axis).checks
    document = inspection(found, checks, trace)
    if draft is not None:
        from bench.rig.given import draft as drafted

        write_text(draft, drafted(found, motor, axis_name))
    if out is not None:
        common.write_picture(out, signals_picture(recording, how))
    common.write_page(report, document)
    common.write_json(json, lambda: to_json(found, {"checks": as_json(checks)}))
    common.tell(document, [out, draft, report], json)


def friction(
    traces: Annotated[list[Path], typer.Argument(metavar="TRACE...", help="Recordings, each at one steady speed.")],
    rig: RigOption,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option(help="Figure to write: .png, .pdf or .svg.")] = None,
    axis_name: AxisOption = None,
    report: ReportOption = None,
) -> None:
    """Tell friction over speed from recordings at one speed each, and name the effect that bends it."""
    from bench.friction_map import friction_map
    from bench.report.friction import SCHEMA, friction_json
    from bench.report.friction import friction as document_of

    axis = bench.load_rig(rig).on_axis(axis_name)
    with common.refusal_as_json(json, SCHEMA):
        found = friction_map([bench.read(trace, axis.trace) for trace in traces], axis)
    document = document_of(found, axis.name)
    common.write_picture(out, document.pictures[0])
    common.write_page(report, document)
    common.write_json(json, lambda: friction_json(found))
    common.tell(document, [out, report], json)


def limits(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: RigOption,
    out: Annotated[Path, typer.Option(help="Diagram to write: .png, .pdf or .svg.")] = Path("limits.png"),
    axis_name: AxisOption = None,
) -> None:
    """Draw a recording into its motor's speed-torque diagram; say how much reserve it leaves."""
    from bench.report.drive import limits as document_of

    axis = bench.load_rig(rig).on_axis(axis_name)
    document = document_of(bench.read(trace, axis.trace), axis)
    common.write_picture(out, document.pictures[0])
    common.tell(document, [out])
