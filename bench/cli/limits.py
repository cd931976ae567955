"""`bench limits`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import AxisOption, RigOption, list_files, say, write_picture


def limits(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: RigOption,
    out: Annotated[Path, typer.Option("--out", help="Diagram to write: .png, .pdf or .svg.")] = Path("limits.png"),
    axis_name: AxisOption = None,
) -> None:
    """Draw a recording into its motor's speed-torque diagram; say how much reserve it leaves."""
    from bench.course.operating_range import trace_in_range
    from bench.report.document import Picture
    from bench.rig.rig import load_rig
    from bench.trace.read import read

    axis = load_rig(rig).on_axis(axis_name)
    found = trace_in_range(read(trace, axis.trace), axis)
    write_picture(out, Picture(name="limits", title="", rows=(found.charts,)))
    say("\n".join(found.findings))
    list_files([out])
