"""`bench replay`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import AxisOption, ReportOption, list_files, say, warn, write_page
from bench.cli.robot import AtOption, BesideRigOption, JointOption, MjcfOption, subject
from bench.files import write_text
from bench.names import readable


def replay(
    model: Annotated[Path, typer.Argument(help="model.toml that diagnose wrote.")],
    trace: Annotated[Path, typer.Argument(help="Recording to run it along.")],
    out: Annotated[Path, typer.Option("--out", help="CSV to write.")],
    rig: BesideRigOption = None,
    axis_name: AxisOption = None,
    report: ReportOption = None,
    mjcf: MjcfOption = None,
    joint: JointOption = None,
    at: AtOption = None,
) -> None:
    """Run a diagnosed model along a recording; write measured and simulated signals."""
    from bench.diagnosis.replay import replay as run_replay

    of = subject(rig, axis_name, mjcf, joint, at)
    replayed = run_replay(model, of.read(trace), of.rig)
    write_text(out, replayed.csv())
    if report is not None:
        from bench.report.replay import replay as document_of

        write_page(report, document_of(replayed, model, readable(trace.name)))
    say(replayed.summary)
    list_files([out, report])
    warn(replayed.warnings)
