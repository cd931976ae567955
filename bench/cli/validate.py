"""`bench validate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.console import JsonOption, console, tell_files, write_json


def validate(
    rigs: Annotated[int, typer.Option("--rigs", help="Runs: an axis, a motion and noise each.", min=1)] = 64,
    seed: Annotated[int, typer.Option("--seed", help="Of all that is drawn.", min=0)] = 0,
    effects: Annotated[
        str, typer.Option("--effects", help="Hidden in each run: a count as 0-3; or names, or all, each in turn.")
    ] = "0",
    diagnose: Annotated[
        bool, typer.Option("--diagnose", help="Name what is missing too, a second or two a run.")
    ] = False,
    workers: Annotated[int | None, typer.Option("--workers", help="Processes on this machine.", min=1)] = None,
    scheduler: Annotated[
        str | None, typer.Option("--scheduler", help="Dask cluster to work on, e.g. tcp://host:8786.")
    ] = None,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for tables, figures and JSON.")] = None,
) -> None:
    """Monte Carlo on synthetic recordings: how far off numbers are, and how often intervals and names hold."""
    from bench import __version__
    from bench.report.progress import progress
    from bench.report.validation import sheets, validation_json, write_validation
    from bench.validate.hiding import Hiding
    from bench.validate.plan import Plan
    from bench.validate.validate import validate as run_validation

    plan = Plan(seed, Hiding.parse(effects), diagnose)
    with progress(f"validating on {rigs} runs") as done:
        found = run_validation(plan, rigs, workers, scheduler, done)
    options = {"rigs": rigs, "seed": seed, "effects": effects, "diagnose": diagnose}
    basis = {"version": __version__, "rig_sha256": None, "traces": [], "options": options}
    command = f"bench validate --rigs {rigs} --seed {seed} --effects {effects}" + " --diagnose" * diagnose
    files = write_validation(out, found, basis, command) if out is not None else []
    if json is not None:
        write_json(json, validation_json(found, basis))
    if json != Path("-"):
        for sheet in sheets(found):
            console().print(sheet.table())
        tell_files(files)
