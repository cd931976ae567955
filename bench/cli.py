"""The command line: every command is thin, one verb of the bench and what a person wants to see of it."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from typer.exceptions import TyperException

from bench import __version__
from bench.console import JsonOption, RigOption, console, tell_files, tell_warnings, write_json
from bench.demo import demo as run_demo
from bench.diagnose.diagnosis import diagnose as run_diagnosis
from bench.diagnose.replay import replay as run_replay
from bench.effects.present import named, parse_effect
from bench.errors import BenchError, InputError
from bench.files import write_text
from bench.friction_map.map import friction_map
from bench.identify.estimate import Estimate
from bench.identify.lab import identify_as_in_the_lab
from bench.identify.refine import Refinement
from bench.identify.refine import refine as polish
from bench.identify.regression import identify as regress
from bench.lab.record import record
from bench.plant.profiles import DEFAULT, PROFILES
from bench.plant.simulate import simulate as run_simulation
from bench.plant.truth import write_truth
from bench.report.course import course_table, report_course
from bench.report.diagnosis import diagnosis_json, diagnosis_table, write_diagnosis
from bench.report.effects import effect_page, effects_table
from bench.report.estimate import estimate_json, estimate_table, refinement_line
from bench.report.friction import draw_friction, friction_json, friction_table
from bench.report.identification import write_identification
from bench.report.limits import draw_operating_range, operating_range
from bench.report.progress import progress
from bench.rig.rig import Rig, load_rig
from bench.trace.inspect import inspect as look
from bench.trace.inspect import table as inspection_table
from bench.trace.inspect import to_json as inspection_json
from bench.trace.read import read
from bench.trace.stream import stream
from bench.trace.write import write

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)


class Estimator(StrEnum):
    """Ways to identify."""

    REGRESSION = "regression"
    LAB = "lab"


@app.callback(invoke_without_command=True)
def bench(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """Test bench for a servo axis: simulate it in MuJoCo, and identify simulated and real ones alike."""
    if version:
        typer.echo(__version__)
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command()
def demo(
    out: Annotated[Path, typer.Option("--out", help="Folder for trace, truth and figures.")] = Path("bench_demo"),
) -> None:
    """Simulate the embedded rig, identify it, and set truth beside estimate."""
    with progress("demo") as done:
        result = run_demo(out, done)
    console().print(estimate_table(result.estimate, result.title, result.truth))
    tell_warnings(result.estimate.warnings)
    tell_files(result.files)


@app.command()
def simulate(
    rig: Annotated[Path, typer.Argument(help="Rig file with [drive] and [simulation].")],
    out: Annotated[Path, typer.Option("--out", help="Trace to write: .csv, .csv.gz, .parquet or .trace.")],
    profile: Annotated[str, typer.Option("--profile", help=f"Motion: {', '.join(PROFILES)}.")] = DEFAULT,
    seed: Annotated[int, typer.Option("--seed", help="Seed of the sensors' noise.", min=0)] = 0,
    effect: Annotated[
        list[str] | None, typer.Option("--effect", help="NAME:key=value,... to add; see bench effects. Repeatable.")
    ] = None,
) -> None:
    """Simulate the axis of a rig in MuJoCo; write its trace and, beside it, the truth."""
    axis = load_rig(rig)
    with progress(f"simulating {axis.name}") as done:
        present = [parse_effect(text, axis.axis_kind) for text in effect or ()]
        simulated = run_simulation(axis, profile, seed, progress=done, effects=present)
    write(simulated.trace, out)
    tell_files([out, write_truth(out, simulated.truth)])


@app.command()
def effects(
    name: Annotated[
        str | None, typer.Argument(help="Effect whose page to print; all of them as a table without.")
    ] = None,
) -> None:
    """List the physical effects the bench knows, or print the page of one: equation, quantities, source."""
    if name is None:
        console().print(effects_table())
    else:
        typer.echo(effect_page(name))


@app.command()
def inspect(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: Annotated[Path | None, typer.Option("--rig", help="Rig file whose [trace.columns] names the signals.")] = None,
    json: JsonOption = None,
) -> None:
    """Say what a recording holds: rate, jitter, holes, signals with their range and resolution."""
    found = look(trace, load_rig(rig).trace.columns if rig else None)
    if json is not None:
        write_json(json, inspection_json(found))
    else:
        console().print(inspection_table(found))


@app.command()
def identify(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: RigOption,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for figures and JSON.")] = None,
    estimator: Annotated[
        Estimator, typer.Option("--estimator", help="lab: as the course does.")
    ] = Estimator.REGRESSION,
    refine: Annotated[bool, typer.Option("--refine", help="Polish by simulation error in MuJoCo.")] = False,
    offset: Annotated[bool, typer.Option("--offset", help="Fit a constant torque (force) too.")] = False,
    cutoff: Annotated[
        float | None, typer.Option("--cutoff", help="Filter's half-power frequency in Hz.", min=1e-6)
    ] = None,
) -> None:
    """Identify inertia, viscous and Coulomb friction of a recording, with 95 % intervals."""
    axis = load_rig(rig)
    axis = axis.model_copy(update={"offset": axis.offset or offset})
    if estimator is Estimator.LAB and (refine or offset or cutoff):
        raise InputError("--estimator lab", "found with --refine, --offset or --cutoff", "allowed: alone")
    estimate, refinement = _estimate(trace, axis, estimator, refine, cutoff)
    if json is not None:
        write_json(json, estimate_json(estimate, refinement))
    files = write_identification(out, trace, axis, estimate, refinement) if out is not None else []
    if json != Path("-"):
        console().print(estimate_table(estimate, f"{axis.name}: {trace.name}"))
        if refinement is not None:
            typer.echo(refinement_line(refinement, axis.axis_kind))
        tell_files(files)
    tell_warnings(estimate.warnings)


@app.command()
def diagnose(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: RigOption,
    holdout: Annotated[Path | None, typer.Option("--holdout", help="Another recording of the axis.")] = None,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for model, figures and JSON.")] = None,
    without: Annotated[list[str] | None, typer.Option("--without", help="Effect not to try. Repeatable.")] = None,
) -> None:
    """Find where model and recording disagree, name the missing effects, and show the gap shrink."""
    axis = load_rig(rig)
    excluded = frozenset(named(name, "--without").name for name in without or [])
    other = read(holdout, axis.trace.columns) if holdout else None
    with progress(f"diagnosing {trace.name}") as done:
        found = run_diagnosis(read(trace, axis.trace.columns), axis, other, excluded, done)
    if json is not None:
        write_json(json, diagnosis_json(found))
    files = write_diagnosis(out, found, f"{axis.name}: {trace.name}") if out is not None else []
    if json != Path("-"):
        console().print(diagnosis_table(found, f"{axis.name}: {trace.name}"))
        tell_files(files)
    tell_warnings(found.warnings)


@app.command()
def replay(
    model: Annotated[Path, typer.Argument(help="model.toml that diagnose wrote.")],
    trace: Annotated[Path, typer.Argument(help="Recording to run it along.")],
    rig: RigOption,
    out: Annotated[Path, typer.Option("--out", help="CSV to write.")],
) -> None:
    """Run a diagnosed model along a recording; write measured and simulated signals."""
    axis = load_rig(rig)
    replayed = run_replay(model, read(trace, axis.trace.columns), axis)
    write_text(out, replayed.csv())
    typer.echo(replayed.says)
    tell_files([out])
    tell_warnings(replayed.warnings)


@app.command()
def friction(
    traces: Annotated[list[Path], typer.Argument(metavar="TRACE...", help="Recordings, each at one steady speed.")],
    rig: RigOption,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Figure to write: .png, .pdf or .svg.")] = None,
) -> None:
    """Tell friction over speed from recordings at one speed each, and name the effect that bends it."""
    axis = load_rig(rig)
    found = friction_map([read(trace, axis.trace.columns) for trace in traces], axis)
    if out is not None:
        draw_friction(found, axis.name, out)
    if json is not None:
        write_json(json, friction_json(found))
    if json != Path("-"):
        console().print(friction_table(found, axis.name))
        tell_files([out] if out is not None else [])


def _estimate(
    trace: Path, rig: Rig, estimator: Estimator, refine: bool, cutoff: float | None
) -> tuple[Estimate, Refinement | None]:
    """Estimate by the method asked for, and what polishing did to it."""
    columns = rig.trace.columns
    if estimator is Estimator.LAB:
        return identify_as_in_the_lab(read(trace, columns), rig), None
    with progress(f"identifying {trace.name}") as done:
        if not refine:
            return regress(stream(trace, columns), rig, cutoff), None
        recording = read(trace, columns)
        return polish(recording, rig, regress(recording, rig, cutoff), done)


@app.command()
def lab(
    data: Annotated[Path | None, typer.Option("--data", help="Folder of your recordings; else synthetic ones.")] = None,
    out: Annotated[Path, typer.Option("--out", help="Folder for the report.")] = Path("bench_lab"),
    synthetic: Annotated[
        Path | None, typer.Option("--record", help="Only simulate the course's recordings, into this folder.")
    ] = None,
) -> None:
    """Do all tasks of the lab course; write one report as HTML and PDF."""
    if synthetic is not None:
        with progress("recording") as done:
            tell_files(record(synthetic, progress=done))
        return
    with progress("lab course") as done:
        report = report_course(data, out, done)
    console().print(course_table(report.results))
    tell_files(report.files)


@app.command()
def limits(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: RigOption,
    out: Annotated[Path, typer.Option("--out", help="Diagram to write: .png, .pdf or .svg.")] = Path("limits.png"),
) -> None:
    """Draw a recording into its motor's speed-torque diagram; say how much reserve it leaves."""
    axis = load_rig(rig)
    found = operating_range(read(trace, axis.trace.columns), axis)
    draw_operating_range(found, out)
    typer.echo("\n".join(found.says))
    tell_files([out])


def main() -> None:
    """Entry point of `bench`: errors become one line on standard error and an exit status."""
    try:
        status = app(standalone_mode=False)
    except BenchError as error:
        sys.exit(_failed(str(error), error.exit_status))
    except TyperException as error:
        sys.exit(_failed(error.format_message(), 2))
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(_failed("interrupted", 130))
    sys.exit(status if isinstance(status, int) else 0)


def _failed(message: str, status: int) -> int:
    line = " ".join(message.replace("Value error, ", "").split())
    if line:
        typer.echo(f"bench: {line}", err=True)
    return status
