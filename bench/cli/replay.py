"""`bench replay`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.console import AxisOption, RigOption, tell_files, tell_warnings
from bench.files import write_text
from bench.names import plain


def replay(
    model: Annotated[Path, typer.Argument(help="model.toml that diagnose wrote.")],
    trace: Annotated[Path, typer.Argument(help="Recording to run it along.")],
    rig: RigOption,
    out: Annotated[Path, typer.Option("--out", help="CSV to write.")],
    axis_name: AxisOption = None,
) -> None:
    """Run a diagnosed model along a recording; write measured and simulated signals."""
    from bench.diagnose.replay import replay as run_replay
    from bench.rig.rig import load_rig
    from bench.trace.read import read

    axis = load_rig(rig).on_axis(axis_name)
    replayed = run_replay(model, read(trace, axis.trace), axis)
    write_text(out, replayed.csv())
    typer.echo(plain(replayed.says))
    tell_files([out])
    tell_warnings(replayed.warnings)
