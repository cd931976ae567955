"""`bench limits`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.console import RigOption, tell_files
from bench.names import plain


def limits(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: RigOption,
    out: Annotated[Path, typer.Option("--out", help="Diagram to write: .png, .pdf or .svg.")] = Path("limits.png"),
) -> None:
    """Draw a recording into its motor's speed-torque diagram; say how much reserve it leaves."""
    from bench.report.limits import draw_operating_range, operating_range
    from bench.rig.rig import load_rig
    from bench.trace.read import read

    axis = load_rig(rig)
    found = operating_range(read(trace, axis.trace.columns), axis)
    draw_operating_range(found, out)
    typer.echo(plain("\n".join(found.says)))
    tell_files([out])
