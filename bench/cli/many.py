"""`bench validate` and `bench fleet`: very many recordings, simulated or real."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import bench
from bench.cli import common
from bench.cli.common import STDOUT, JsonOption
from bench.errors import InputError, UndeterminedError
from bench.files import keeping, sha256, write_text
from bench.plant.profile_names import DEFAULT, NAMES

if TYPE_CHECKING:
    from bench.fleet.fleet import Fleet
    from bench.validation.own import OwnAxis

SUMMARY = "summary.json"


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
    from bench.report.parts import provenance
    from bench.report.terminal import progress
    from bench.report.validation import validation, validation_json, write_validation
    from bench.validation.plan import Hiding, Plan, any_axis
    from bench.validation.validate import validate as run_validation

    if rig is None and str(profile) != DEFAULT:
        raise InputError("--profile", "found without --rig", "allowed: with the rig whose motion it is")
    hiding = Hiding.parse(effects)
    named = diagnose or (rig is not None and hiding.anything)  # what is hidden in one's own axis is to be named
    options = {"rigs": rigs, "seed": seed, "effects": effects, "diagnose": named, "profile": str(profile)}
    population, basis = (any_axis, provenance(None, [], options)) if rig is None else _own(rig, profile, options)
    plan = Plan(seed, hiding, named, population)
    with progress(f"validating on {rigs} runs") as done:
        found = run_validation(plan, rigs, workers, scheduler, done)
    command = f"bench validate --rigs {rigs} --seed {seed} --effects {effects}{' --diagnose' * named}"
    command += "" if rig is None else f" --rig {rig} --profile {profile}"
    document = validation(found, basis, command, rig is not None)
    written = [] if out is None else write_validation(out, found, basis, command, rig is not None)
    if json is not None:
        common.write_json(json, validation_json(found, basis))
    common.tell(document, written, json)


def _own(rig: Path, profile: Path, options: dict[str, object]) -> tuple[OwnAxis, dict[str, Any]]:
    """The axis of a rig along a named motion, or the one of a file, and what it rests on."""
    from bench.report.parts import provenance
    from bench.validation.own import own_axis

    known = bench.load_rig(rig)
    if str(profile) in NAMES:
        return own_axis(known, str(profile), None), provenance(rig, [], options)
    if not profile.exists():
        raise InputError("--profile", f"found '{profile}'", f"allowed: the file of a recording, or {', '.join(NAMES)}")
    return own_axis(known, profile.name, bench.read(profile, known.trace)), provenance(rig, [profile], options)


def fleet(
    manifest: Annotated[Path, typer.Argument(metavar="MANIFEST", help="CSV or Parquet: file, rig, axis, time, ...")],
    out: Annotated[Path, typer.Option("--out", help="Folder for results, table, summary and page.")],
    diagnose: Annotated[bool, typer.Option("--diagnose", help="Name missing effects too.")] = False,
    retry: Annotated[bool, typer.Option("--retry", help="Do again what failed or timed out.")] = False,
    deadline: Annotated[float, typer.Option("--deadline", help="Of one recording, in s.", min=0.1)] = 120.0,
    memory: Annotated[float, typer.Option("--memory", help="Of one recording, in GB.", min=0.25)] = 4.0,
    workers: Annotated[int | None, typer.Option("--workers", help="Processes (preset: one a core).", min=1)] = None,
    scheduler: Annotated[str | None, typer.Option("--scheduler", help="Dask's, e.g. tcp://host:8786.")] = None,
    json: JsonOption = None,
) -> None:
    """Evaluate many recordings of many axes: one row each, which axes changed since when, and which need a person."""
    from bench.fleet.fleet import TABLE
    from bench.fleet.fleet import fleet as run_fleet
    from bench.jobs.process import Limits
    from bench.report.fleet import fleet_document, fleet_json
    from bench.report.publish import write_html
    from bench.report.terminal import progress

    limits = Limits(deadline, memory * 1024**3)
    basis = {"version": bench.__version__, "manifest_sha256": sha256(manifest), "options": {"diagnose": diagnose}}
    page = out / "fleet.html"

    def write_document(found: Fleet) -> None:
        with keeping(found.manifest.inputs):
            write_text(out / SUMMARY, fleet_json(found, basis) + "\n")
            write_html(page, fleet_document(found, SUMMARY, basis))

    with progress(f"evaluating {manifest.name}") as done:
        found = run_fleet(manifest, out, diagnose, retry, limits, workers, scheduler, done, write_document)
    if json is not None:
        common.write_json(json, fleet_json(found, basis))
    common.tell(fleet_document(found, SUMMARY, basis), (out / TABLE, out / SUMMARY, page), json)
    if json != STDOUT:
        common.say(f"{found.evaluated} evaluated now")
    if not found.summary.counts["done"]:
        reason = f"none of {len(found.manifest)} recordings gave a result"
        raise UndeterminedError("the fleet", reason, f"what the column `reason` of {out / TABLE} asks for")
