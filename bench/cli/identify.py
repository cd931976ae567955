"""`bench identify`."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bench.console import (
    AxisOption,
    JsonOption,
    RigOption,
    console,
    tell_files,
    tell_warnings,
    told_in_json,
    write_json,
)
from bench.errors import InputError

if TYPE_CHECKING:
    from bench.identify.estimate import Estimate
    from bench.identify.refine import Refinement
    from bench.rig.rig import Rig


class Estimator(StrEnum):
    """Ways to identify."""

    REGRESSION = "regression"
    LAB = "lab"


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
    axis_name: AxisOption = None,
) -> None:
    """Identify inertia, viscous and Coulomb friction of a recording, with 95 % intervals."""
    from bench.checks.gate import spoken
    from bench.identify.estimate import RefusedEstimateError
    from bench.report.estimate import SCHEMA, estimate_json, estimate_table, refinement_line
    from bench.rig.rig import load_rig

    axis = load_rig(rig).on_axis(axis_name)
    axis = axis.model_copy(update={"offset": axis.offset or offset})
    if estimator is Estimator.LAB and (refine or offset or cutoff):
        raise InputError("--estimator lab", "found with --refine, --offset or --cutoff", "allowed: alone")
    try:
        with told_in_json(json, SCHEMA):
            estimate, refinement = _estimate(trace, axis, estimator, refine, cutoff)
    except RefusedEstimateError as refusal:
        if json is not None:
            write_json(json, estimate_json(refusal.estimate, refused=str(refusal)))
        tell_warnings(refusal.estimate.warnings)
        raise
    if json is not None:
        write_json(json, estimate_json(estimate, refinement))
    files = []
    if out is not None:
        from bench.report.identification import write_identification  # matplotlib: 0.35 s

        files = write_identification(out, trace, axis, estimate, refinement)
    if json != Path("-"):
        console().print(estimate_table(estimate, f"{axis.name}: {trace.name}"))
        if refinement is not None:
            typer.echo(refinement_line(refinement, axis.axis_kind))
        tell_files(files)
    tell_warnings([*estimate.warnings, *spoken(estimate.checks)])


def _estimate(
    trace: Path, rig: Rig, estimator: Estimator, refine: bool, cutoff: float | None
) -> tuple[Estimate, Refinement | None]:
    """Estimate by the method asked for, and what polishing did to it."""
    from bench.checks.gate import passed
    from bench.trace.read import read

    how = rig.trace
    if estimator is Estimator.LAB:
        from bench.identify.lab import identify_as_in_the_lab

        gated = passed(read(trace, how), rig)
        return replace(identify_as_in_the_lab(gated.trace, rig), checks=gated.checks), None
    from bench.identify.regression import identify as regress
    from bench.report.progress import progress
    from bench.trace.stream import stream

    with progress(f"identifying {trace.name}") as done:
        if not refine:
            return regress(stream(trace, how), rig, cutoff), None
        from bench.identify.refine import refine as polish  # MuJoCo: 0.1 s

        recording = passed(read(trace, how), rig).trace
        return polish(recording, rig, regress(recording, rig, cutoff), done)
