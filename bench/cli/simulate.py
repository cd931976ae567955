"""`bench simulate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import ReportOption, list_files, write_page
from bench.names import readable
from bench.plant.profile_names import DEFAULT, NAMES


def simulate(
    rig: Annotated[Path, typer.Argument(help="Rig file with [drive] and [simulation].")],
    out: Annotated[Path, typer.Option("--out", help="Trace to write: .csv, .csv.gz, .parquet or .trace.")],
    profile: Annotated[str, typer.Option("--profile", help=f"Motion: {', '.join(NAMES)}.")] = DEFAULT,
    seed: Annotated[int, typer.Option("--seed", help="Seed of the sensors' noise.", min=0)] = 0,
    effect: Annotated[
        list[str] | None, typer.Option("--effect", help="NAME:key=value,... to add; see bench effects. Repeatable.")
    ] = None,
    report: ReportOption = None,
) -> None:
    """Simulate the axis of a rig in MuJoCo; write its trace and, beside it, the truth."""
    from bench.effects.present import parse_effect
    from bench.files import held
    from bench.plant.simulate import simulate as run_simulation
    from bench.plant.simulate import write_truth
    from bench.report.terminal import progress
    from bench.rig.rig import load_rig, require
    from bench.trace.write import write

    axis = load_rig(rig)
    require(axis, "simulate")
    with progress(f"simulating {axis.name}") as done:
        present = [parse_effect(text, axis.axis_kind) for text in effect or ()]
        simulated = run_simulation(axis, profile, seed, progress=done, effects=present)
    with held(out.parent):  # a trace and its own truth, not that of a run beside this one
        write(simulated.trace, out)
        truth = write_truth(out, simulated.truth)
    if report is not None:
        from bench.report.simulation import simulation

        write_page(report, simulation(simulated, readable(out.name)))
    list_files([out, truth, report])
