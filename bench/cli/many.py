"""`bench validate` and `bench fleet`: very many recordings, simulated or real."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import bench
from bench.cli import common
from bench.cli.common import STDOUT, JsonOption, OptionalRigOption
from bench.errors import InputError, UndeterminedError
from bench.files import sha256
from bench.names import readable
from bench.plant.profile_names import DEFAULT, NAMES

if TYPE_CHECKING:
    from bench.validation.plan import OwnAxis


Effects = Annotated[
    str, typer.Option("--effects", help="Hidden in each run: a count as 0-3; or names, or all, each in turn.")
]
Profile = Annotated[Path, common.profile_option("With --rig, its motion: a recording's file, or")]
Into = Annotated[Path | None, typer.Option("--into", help="Instead: your recording, to put known effects into.")]
EffectOption = Annotated[list[str] | None, common.effect_option("With --into, instead of all.")]
Strength = Annotated[
    list[float] | None,
    typer.Option("--strength", help="With --into, over what it leaves; else the least named is sought. Repeatable."),
]
Scheduler = Annotated[str | None, typer.Option("--scheduler", help="Dask cluster to work on, e.g. tcp://host:8786.")]


def validate(
    rigs: Annotated[int, typer.Option(help="Runs: an axis, a motion and noise each.", min=1)] = 64,
    seed: Annotated[int, typer.Option(help="Of all that is drawn.", min=0)] = 0,
    effects: Effects = "0",
    diagnose: Annotated[
        bool, typer.Option("--diagnose", help="Name what is missing too, a second or two a run.")
    ] = False,
    rig: OptionalRigOption = None,
    profile: Profile = Path(DEFAULT),
    into: Into = None,
    effect: EffectOption = None,
    strength: Strength = None,
    workers: Annotated[int | None, typer.Option(help="Processes on this machine.", min=1)] = None,
    scheduler: Scheduler = None,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option(help="Folder for page, tables, figures and JSON.")] = None,
) -> None:
    """How far off numbers are, how often intervals and names hold: by Monte Carlo, or of effects in your recording."""
    from bench.report.parts import provenance
    from bench.report.terminal import progress
    from bench.report.validation import validation, validation_json, write_validation
    from bench.validation.plan import Hiding, Plan, any_axis
    from bench.validation.validate import validate as run_validation

    if into is not None:
        _into(into, rig, effect or [], strength or [], seed, workers, json, out)
        return
    if effect or strength:
        raise InputError("--effect or --strength", "found without --into", "allowed: with a recording to put them into")
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
    written = [] if out is None else write_validation(out, found, document)
    common.write_json(json, lambda: validation_json(found, basis))
    common.tell(document, written, json)


def _into(
    into: Path,
    rig: Path | None,
    effects: list[str],
    strengths: list[float],
    seed: int,
    workers: int | None,
    json: Path | None,
    out: Path | None,
) -> None:
    """Known effects in one's own recording."""
    from bench.report.injection import injections, injections_json
    from bench.report.parts import provenance
    from bench.report.terminal import progress
    from bench.validation.into import inject

    if rig is None:
        raise InputError("--into", "found without --rig", "allowed: with the rig of the recording's axis")
    if not all(0.0 < one < math.inf for one in strengths):
        raise InputError("--strength", f"found {min(strengths):g}", "allowed: positive numbers, as 2 or 5")
    known = bench.load_rig(rig)
    options = {"effect": effects, "strength": strengths, "seed": seed}
    with progress(f"putting effects into {into.name}") as done:
        found = inject(bench.read(into, known.trace), known, effects, strengths, seed, workers, done)
    basis = provenance(rig, [into], options)
    document = injections(found, basis, readable(into.name))
    common.deliver(document, lambda: injections_json(found, basis), json, out)


def _own(rig: Path, profile: Path, options: dict[str, object]) -> tuple[OwnAxis, dict[str, Any]]:
    """The axis of a rig along a named motion, or the one of a file, and what it rests on."""
    from bench.report.parts import provenance
    from bench.validation.plan import own_axis

    known = bench.load_rig(rig)
    if str(profile) in NAMES:
        return own_axis(known, str(profile), None), provenance(rig, [], options)
    if not profile.exists():
        raise InputError("--profile", f"found '{profile}'", f"allowed: the file of a recording, or {', '.join(NAMES)}")
    return own_axis(known, profile.name, bench.read(profile, known.trace)), provenance(rig, [profile], options)


def fleet(
    manifest: Annotated[Path, typer.Argument(metavar="MANIFEST", help="CSV or Parquet: file, rig, axis, time, ...")],
    out: Annotated[Path, typer.Option(help="Folder for results, table, summary and page.")],
    diagnose: Annotated[bool, typer.Option("--diagnose", help="Name missing effects too.")] = False,
    retry: Annotated[bool, typer.Option("--retry", help="Do again what failed or timed out.")] = False,
    deadline: Annotated[float, typer.Option(help="Of one recording, in s.", min=0.1)] = 120.0,
    memory: Annotated[float, typer.Option(help="Of one recording, in GB.", min=0.25)] = 4.0,
    workers: Annotated[int | None, typer.Option(help="Processes (preset: one a core).", min=1)] = None,
    scheduler: Annotated[str | None, typer.Option(help="Dask's, e.g. tcp://host:8786.")] = None,
    storage: Annotated[
        list[str] | None, typer.Option(help="fsspec's name of one that the manifest may name. Repeatable.")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Evaluate many recordings of many axes: one row each, which axes changed since when, and which need a person."""
    from bench.fleet.fleet import TABLE
    from bench.fleet.fleet import fleet as run_fleet
    from bench.jobs.process import Limits
    from bench.report.fleet import FLEET, SUMMARY, fleet_document, fleet_json, write_fleet
    from bench.report.terminal import progress

    limits = Limits(deadline, memory * 1024**3)
    basis = {"version": bench.__version__, "manifest_sha256": sha256(manifest), "options": {"diagnose": diagnose}}
    publish = partial(write_fleet, out, provenance=basis)
    with progress(f"evaluating {manifest.name}") as done:
        found = run_fleet(manifest, out, diagnose, retry, limits, workers, scheduler, done, publish, storage or ())
    common.write_json(json, lambda: fleet_json(found, basis))
    common.tell(fleet_document(found, basis), (out / TABLE, out / SUMMARY, out / FLEET), json)
    if json != STDOUT:
        common.say(f"{found.evaluated} evaluated now")
    if not found.summary.counts["done"]:
        reason = f"none of {len(found.manifest)} recordings gave a result"
        raise UndeterminedError("the fleet", reason, f"what the column `reason` of {out / TABLE} asks for")
