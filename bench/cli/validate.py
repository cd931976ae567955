"""`bench validate`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bench.cli.common import JsonOption, tell, write_json
from bench.errors import InputError
from bench.plant.profile_names import DEFAULT, NAMES

if TYPE_CHECKING:
    from bench.validation.own import OwnAxis


def validate(
    rigs: Annotated[int, typer.Option("--rigs", help="Runs: an axis, a motion and noise each.", min=1)] = 64,
    seed: Annotated[int, typer.Option("--seed", help="Of all that is drawn.", min=0)] = 0,
    effects: Annotated[
        str, typer.Option("--effects", help="Hidden in each run: a count as 0-3; or names, or all, each in turn.")
    ] = "0",
    diagnose: Annotated[
        bool, typer.Option("--diagnose", help="Name what is missing too, a second or two a run.")
    ] = False,
    rig: Annotated[Path | None, typer.Option("--rig", help="Your own axis instead of any: its rig file.")] = None,
    profile: Annotated[
        Path, typer.Option("--profile", help=f"With --rig, its motion: a recording's file, or {', '.join(NAMES)}.")
    ] = Path(DEFAULT),
    workers: Annotated[int | None, typer.Option("--workers", help="Processes on this machine.", min=1)] = None,
    scheduler: Annotated[
        str | None, typer.Option("--scheduler", help="Dask cluster to work on, e.g. tcp://host:8786.")
    ] = None,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for page, tables, figures and JSON.")] = None,
) -> None:
    """Monte Carlo on synthetic recordings: how far off numbers are, and how often intervals and names hold."""
    from bench.report.provenance import without_files
    from bench.report.terminal import progress
    from bench.report.validation import validation, validation_json, write_validation
    from bench.validation.plan import AnyAxis, Hiding, Plan
    from bench.validation.validate import validate as run_validation

    if rig is None and str(profile) != DEFAULT:
        raise InputError("--profile", "found without --rig", "allowed: with the rig whose motion it is")
    hiding = Hiding.parse(effects)
    named = diagnose or (rig is not None and hiding.anything)  # what is hidden in one's own axis is to be named
    options = {"rigs": rigs, "seed": seed, "effects": effects, "diagnose": named, "profile": str(profile)}
    population, basis = (AnyAxis(), without_files(options)) if rig is None else _own(rig, profile, options)
    plan = Plan(seed, hiding, named, population)
    with progress(f"validating on {rigs} runs") as done:
        found = run_validation(plan, rigs, workers, scheduler, done)
    command = f"bench validate --rigs {rigs} --seed {seed} --effects {effects}{' --diagnose' * named}"
    command += "" if rig is None else f" --rig {rig} --profile {profile}"
    document = validation(found, basis, command, rig is not None)
    written = [] if out is None else write_validation(out, found, basis, command, rig is not None)
    if json is not None:
        write_json(json, validation_json(found, basis))
    tell(document, written, json)


def _own(rig: Path, profile: Path, options: dict[str, object]) -> tuple[OwnAxis, dict[str, Any]]:
    """The axis of a rig along a named motion, or the one of a file, and what it rests on."""
    from bench.report.provenance import provenance
    from bench.rig.rig import load_rig
    from bench.trace.read import read
    from bench.validation.own import own_axis

    known = load_rig(rig)
    if str(profile) in NAMES:
        return own_axis(known, str(profile), None), provenance(rig, [], options)
    if not profile.exists():
        raise InputError("--profile", f"found '{profile}'", f"allowed: the file of a recording, or {', '.join(NAMES)}")
    return own_axis(known, profile.name, read(profile, known.trace)), provenance(rig, [profile], options)
