"""`bench demo`, `simulate`, `plan`, `list`, `report` and `validate`: commands that need no recording."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer
from typer import Argument, Option

import bench
from bench.cli import common
from bench.cli.common import JsonOption, OptionalRigOption, ReportOption, RigArgument, RigOption
from bench.errors import InputError
from bench.files import held, read_text, write_text
from bench.names import readable
from bench.plant.profile_names import DEFAULT, NAMES

if TYPE_CHECKING:
    from bench.validation.plan import OwnAxis

#: Seed of the demo that is run unless another is given: one that hides what a person sees in the picture, too.
SHOWN = 12


def demo(
    out: Annotated[Path, Option(help="Folder for trace, truth, model and page.")] = Path("bench_demo"),
    seed: Annotated[int, Option(help="Draws the effect that is hidden.", min=0)] = SHOWN,
) -> None:
    """Hide an effect in a simulated axis, find it, add it to the model, and compare the result with the truth."""
    from bench.demo import demo as run_demo
    from bench.report.terminal import progress

    with progress("demo") as done:
        found, files = run_demo(out, seed, done)
    common.tell(found, files)
    common.say(f"\nthe page: {readable(out / 'report.html')}\nyour recording: bench diagnose RECORDING --out found")


def simulate(
    rig: RigArgument,
    out: Annotated[Path, Option(help="Trace to write: .csv, .csv.gz, .parquet or .trace; or a folder.")],
    profile: Annotated[str, common.profile_option("Motion:")] = DEFAULT,
    seed: Annotated[int, Option(help="Seed of the sensors' noise.", min=0)] = 0,
    effect: Annotated[
        list[str] | None, common.effect_option("NAME:key=value,... to add; see bench list effects.")
    ] = None,
    report: ReportOption = None,
) -> None:
    """Simulate the axis of a rig in MuJoCo; write its trace and a file with the true values."""
    from bench.effects.present import parse_effect
    from bench.plant.simulate import write_truth
    from bench.report.terminal import progress
    from bench.rig.rig import require
    from bench.trace.write import write

    axis = bench.load_rig(rig)
    require(axis, "simulate")
    with progress(f"simulating {axis.name}") as done:
        present = [parse_effect(text, axis.axis_kind) for text in effect or ()]
        simulated = bench.simulate(axis, profile, seed, progress=done, effects=present)
    out = common.file_in(out, "trace.csv.gz")
    with held(out.parent):  # a trace and its own truth, not that of a run at the same time
        write(simulated.trace, out)
        truth = write_truth(out, simulated.truth)
    if report is not None:
        from bench.report.simulation import simulation

        how = ["diagnose", out, "--rig", rig, "--out", "found"] if present else ["identify", out, "--rig", rig]
        common.write_page(report, simulation(simulated, readable(out.name), common.typed(*how)))
    common.list_files([out, truth, report])
    common.warn(simulated.warnings)


def plan(
    rig: RigOption,
    out: Annotated[Path, Option(help="CSV of the motion, for a controller; or a folder.")],
    wanted: Annotated[
        str | None, Option("--for", help="NAME:key=value,... of an effect to determine; see bench list effects.")
    ] = None,
    period: Annotated[float, Option(help="Between rows of the CSV in ms.", min=1e-3)] = 1.0,
    profile: Annotated[str | None, common.profile_option("This one, not the best:")] = None,
) -> None:
    """Plan the most informative motion within the rig's limits, and predict the intervals that it gives."""
    from bench.effects.present import parse_effect
    from bench.export.feedforward import DriveUnits
    from bench.export.plan import motions
    from bench.report.drive import others_line, plan_table
    from bench.report.terminal import progress
    from bench.rig.rig import require

    axis = bench.load_rig(rig)
    require(axis, "plan")
    units = DriveUnits.of(axis)
    effect = None if wanted is None else parse_effect(wanted, axis.axis_kind)
    with progress(f"planning for {axis.name}"):
        found = motions(axis, effect, profile)
    best = found[0]
    counted = ((unit.text, unit.factor) for unit in (units.position, units.velocity))
    out = common.file_in(out, "motion.csv")
    write_text(out, best.motion.csv(period * 1e-3, *counted))
    common.printed(plan_table(best))
    common.say(others_line(found))
    common.list_files([out])


def list_(
    what: Annotated[
        Literal["rigs", "effects"] | None, Argument(metavar="WHAT", help="rigs, or effects; both without.")
    ] = None,
    name: Annotated[
        str | None, Argument(metavar="NAME", help="One of them, or a rig file of your own, to print in full.")
    ] = None,
    out: Annotated[Path | None, Option(help="Copy of the rig file to write, or a folder for it.")] = None,
) -> None:
    """List shipped rigs and physical effects, print one in full, or copy a rig file."""
    from bench.report.effects import effect_page, effects_table

    if out is not None and (what != "rigs" or name is None):
        from bench.rig.rig import shipped

        raise InputError("--out", "found without a rig", f"allowed: `bench list rigs NAME`, of {', '.join(shipped())}")
    if what != "effects":
        _rigs(name, out)
    if what is None:
        common.say("")
    if what != "rigs" and name is None:
        common.printed(effects_table())
    elif what == "effects" and name is not None:
        common.say(effect_page(name))


def _rigs(name: str | None, out: Path | None) -> None:
    """List shipped rigs, or print which commands a rig file suffices for and what it is missing, and copy it."""
    from bench.rig.rig import lacking, rig_file, shipped, without_constant

    if name is None:
        for stem, path in shipped().items():
            common.say(f"{stem:12} {bench.load_rig(path).name}")
        return
    path = rig_file(name)
    if out is not None:
        out = common.file_in(out, path.name)
        write_text(out, read_text(path, "a rig file"))
        common.list_files([out])
    rig = bench.load_rig(path)
    common.say(f"{rig.name}, {rig.kind}")
    for command, keys in lacking(rig).items():
        common.say(f"bench {command}: {'missing ' + ', '.join(keys) if keys else 'suffices'}")
    remark = without_constant(rig)
    if remark is not None:
        common.say(f"note: {remark}")


def report(
    folders: Annotated[list[Path], Argument(metavar="DIR", help="Folders that --out of a command wrote.")],
    script: Annotated[Path | None, Option(help="Script file to write that the pages share, for many of them.")] = None,
    opened: Annotated[bool, Option("--open", help="Open the pages in the browser.")] = False,
) -> None:
    """Write report.html of folders again, from the report.json in each."""
    from bench.report.publish import rebuild

    written = rebuild(folders, script)
    common.list_files(written)
    for page in written if opened else ():
        if page != script:
            typer.launch(page.resolve().as_uri())


def validate(
    rigs: Annotated[int, Option(help="Runs: an axis, a motion and noise each.", min=1)] = 64,
    seed: Annotated[int, Option(help="Of all that is drawn.", min=0)] = 0,
    effects: Annotated[str, Option(help="Hidden in each run: a count as 0-3; or names, or all, each in turn.")] = "0",
    diagnose: Annotated[bool, Option("--diagnose", help="Name what is missing too, a second or two a run.")] = False,
    rig: OptionalRigOption = None,
    profile: Annotated[Path, common.profile_option("With --rig, its motion: a recording's file, or")] = Path(DEFAULT),
    into: Annotated[Path | None, Option(help="Instead: your recording, to put known effects into.")] = None,
    effect: Annotated[list[str] | None, common.effect_option("With --into, instead of all.")] = None,
    strength: Annotated[
        list[float] | None,
        Option(help="With --into, relative to its residual; else the least found is searched for. Repeatable."),
    ] = None,
    workers: Annotated[int | None, Option(help="Processes on this machine.", min=1)] = None,
    scheduler: Annotated[str | None, Option(help="Dask cluster to work on, e.g. tcp://host:8786.")] = None,
    json: JsonOption = None,
    out: Annotated[Path | None, Option(help="Folder for page, tables, figures and JSON.")] = None,
) -> None:
    """Measure errors, coverage of intervals and rates of detection by simulation, or in your own recording (--into)."""
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
    """The axis of a rig along a named motion, or the one of a file, and what it is based on."""
    from bench.report.parts import provenance
    from bench.validation.plan import own_axis

    known = bench.load_rig(rig)
    if str(profile) in NAMES:
        return own_axis(known, str(profile), None), provenance(rig, [], options)
    if not profile.exists():
        raise InputError("--profile", f"found '{profile}'", f"allowed: the file of a recording, or {', '.join(NAMES)}")
    return own_axis(known, profile.name, bench.read(profile, known.trace)), provenance(rig, [profile], options)
