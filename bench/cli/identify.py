"""`bench identify`."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bench.cli.robot import AtOption, BesideRigOption, JointOption, MjcfOption, subject
from bench.console import (
    AxisOption,
    Figures,
    FiguresOption,
    JsonOption,
    TracesArgument,
    console,
    print_files,
    print_warnings,
    refusal_as_json,
    write_json,
)
from bench.errors import InputError
from bench.names import in_a_row

if TYPE_CHECKING:
    from bench.cli.robot import Subject
    from bench.fit.estimate import Estimate
    from bench.fit.refine import Refinement
    from bench.rig.rig import Rig
    from bench.trace.trace import Trace


class Estimator(StrEnum):
    """Ways to identify."""

    REGRESSION = "regression"
    LAB = "lab"


def identify(
    traces: TracesArgument,
    rig: BesideRigOption = None,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for figures and JSON.")] = None,
    estimator: Annotated[Estimator, typer.Option("--estimator", help="lab: as in courses.")] = Estimator.REGRESSION,
    refine: Annotated[bool, typer.Option("--refine", help="Polish by simulation error in MuJoCo.")] = False,
    offset: Annotated[bool, typer.Option("--offset", help="Fit a constant torque (force) too.")] = False,
    cutoff: Annotated[
        float | None, typer.Option("--cutoff", help="Filter's half-power frequency in Hz.", min=1e-6)
    ] = None,
    axis_name: AxisOption = None,
    mjcf: MjcfOption = None,
    joint: JointOption = None,
    at: AtOption = None,
    figures: FiguresOption = Figures.PNG,
) -> None:
    """Identify inertia, viscous and Coulomb friction of a recording, or of several together, with 95 % intervals."""
    from bench.files import held
    from bench.fit.estimate import RefusedEstimateError
    from bench.gate.gate import warnings_of
    from bench.report.estimate import SCHEMA, estimate_json
    from bench.report.provenance import provenance

    of = subject(rig, axis_name, mjcf, joint, at)
    axis = of.rig.model_copy(update={"offset": of.rig.offset or offset})
    _require_consistent(traces, estimator, refine, bool(offset or cutoff))
    options = {"estimator": estimator.value, "refine": refine, "offset": axis.offset, "cutoff": cutoff}
    options |= {"joint": joint, "at": at or []} if of.robot else {}
    basis = partial(provenance, rig, traces, options, None, mjcf)
    try:
        with refusal_as_json(json, SCHEMA):
            estimate, refinement = _estimate(traces, replace(of, rig=axis), estimator, refine, cutoff)
    except RefusedEstimateError as refusal:
        if json is not None:
            write_json(json, estimate_json(refusal.estimate, None, str(refusal), basis()))
        print_warnings(refusal.estimate.warnings)
        raise
    with nullcontext() if out is None else held(out):
        files = _write(out, traces, axis, estimate, refinement, basis(), of.whole, figures.ending)
        if json is not None:
            write_json(json, estimate_json(estimate, refinement, None, basis()))
    if json != Path("-"):
        _print(estimate, refinement, axis, in_a_row(traces))
        print_files(files)
    print_warnings([*estimate.warnings, *warnings_of(estimate.checks)])


def _write(
    out: Path | None,
    traces: list[Path],
    axis: Rig,
    estimate: Estimate,
    refinement: Refinement | None,
    basis: dict[str, Any],
    read: Callable[[Path], Trace] | None,
    ending: str,
) -> list[Path]:
    """Figures, page and JSON into a folder, if one is asked for."""
    if out is None:
        return []
    from bench.report.identification import write_identification  # matplotlib: 0.35 s

    return write_identification(out, traces, axis, estimate, refinement, basis, read, ending)


def _print(estimate: Estimate, refinement: Refinement | None, axis: Rig, names: str) -> None:
    """Tables for a person."""
    from bench.report.estimate import estimate_table, recordings_table, refinement_line

    console().print(estimate_table(estimate, f"{axis.name}: {names}"))
    if estimate.recordings:
        console().print(recordings_table(estimate))
    if refinement is not None:
        typer.echo(refinement_line(refinement, axis.axis_kind))


def _require_consistent(traces: list[Path], estimator: Estimator, refine: bool, tuned: bool) -> None:
    """InputError where options contradict each other, or the number of recordings."""
    lab = estimator is Estimator.LAB
    if lab and (refine or tuned):
        raise InputError("--estimator lab", "found with --refine, --offset or --cutoff", "allowed: alone")
    if len(traces) > 1 and (refine or lab):
        found = f"found with {len(traces)} recordings"
        raise InputError("--refine" if refine else "--estimator lab", found, "allowed: with one recording")


def _estimate(
    traces: list[Path], of: Subject, estimator: Estimator, refine: bool, cutoff: float | None
) -> tuple[Estimate, Refinement | None]:
    """Estimate by the method asked for, and what polishing did to it."""
    from bench.gate.gate import passed

    rig, trace = of.rig, traces[0]
    if estimator is Estimator.LAB:
        from bench.fit.lab import identify_as_in_the_lab

        gated = passed(of.read(trace), rig)
        return replace(identify_as_in_the_lab(gated.trace, rig), checks=gated.checks), None
    from bench.fit.regression import identify as regress
    from bench.report.progress import progress
    from bench.trace.stream import stream

    with progress(f"identifying {', '.join(each.name for each in traces)}") as done:
        if not refine:
            parts = [of.read(each) if of.robot else stream(each, rig.trace) for each in traces]
            return regress(parts, rig, cutoff), None
        from bench.fit.refine import refine as polish  # MuJoCo: 0.1 s

        recording = passed(of.read(trace), rig).trace
        return polish(recording, rig, regress(recording, rig, cutoff), done)
