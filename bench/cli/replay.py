"""`bench replay`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.robot import AtOption, BesideRigOption, JointOption, MjcfOption, subject
from bench.console import AxisOption, tell_files, tell_warnings
from bench.files import write_text
from bench.names import plain


def replay(
    model: Annotated[Path, typer.Argument(help="model.toml that diagnose wrote.")],
    trace: Annotated[Path, typer.Argument(help="Recording to run it along.")],
    out: Annotated[Path, typer.Option("--out", help="CSV to write.")],
    rig: BesideRigOption = None,
    axis_name: AxisOption = None,
    mjcf: MjcfOption = None,
    joint: JointOption = None,
    at: AtOption = None,
) -> None:
    """Run a diagnosed model along a recording; write measured and simulated signals."""
    from bench.diagnose.replay import replay as run_replay

    of = subject(rig, axis_name, mjcf, joint, at)
    replayed = run_replay(model, of.read(trace), of.rig)
    write_text(out, replayed.csv())
    typer.echo(plain(replayed.says))
    tell_files([out])
    tell_warnings(replayed.warnings)
