"""`bench replay`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.console import AxisOption, ReportOption, RigOption, tell_files, tell_warnings
from bench.files import read_text, write_text
from bench.names import plain


def replay(
    model: Annotated[Path, typer.Argument(help="model.toml that diagnose wrote.")],
    trace: Annotated[Path, typer.Argument(help="Recording to run it along.")],
    rig: RigOption,
    out: Annotated[Path, typer.Option("--out", help="CSV to write.")],
    axis_name: AxisOption = None,
    report: ReportOption = None,
) -> None:
    """Run a diagnosed model along a recording; write measured and simulated signals."""
    from bench.diagnose.replay import replay as run_replay
    from bench.rig.rig import load_rig
    from bench.trace.read import read

    axis = load_rig(rig).on_axis(axis_name)
    replayed = run_replay(model, read(trace, axis.trace), axis)
    write_text(out, replayed.csv())
    if report is not None:
        from bench.report.page.blocks import File
        from bench.report.page.folder import write_html
        from bench.report.pages.replay import replay_page

        file = File(name=model.name, about="the model", media="application/toml", content=read_text(model, "a model"))
        write_html(report, replay_page(replayed, f"{model.name} along {trace.name}", [file]))
    typer.echo(plain(replayed.says))
    tell_files([path for path in (out, report) if path is not None])
    tell_warnings(replayed.warnings)
