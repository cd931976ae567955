"""`bench limits`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import AxisOption, RigOption, tell, write_picture


def limits(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: RigOption,
    out: Annotated[Path, typer.Option("--out", help="Diagram to write: .png, .pdf or .svg.")] = Path("limits.png"),
    axis_name: AxisOption = None,
) -> None:
    """Draw a recording into its motor's speed-torque diagram; say how much reserve it leaves."""
    from bench.report.limits import limits as document_of
    from bench.rig.rig import load_rig
    from bench.trace.read import read

    axis = load_rig(rig).on_axis(axis_name)
    document = document_of(read(trace, axis.trace), axis)
    write_picture(out, document.pictures[0])
    tell(document, [out])
