"""`bench diagnose`."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import (
    AxisOption,
    Figures,
    FiguresOption,
    JsonOption,
    TracesArgument,
    refusal_as_json,
    tell,
    write_json,
)
from bench.cli.robot import AtOption, BesideRigOption, JointOption, MjcfOption, subject
from bench.names import in_a_row


def diagnose(
    traces: TracesArgument,
    rig: BesideRigOption = None,
    holdout: Annotated[
        Path | None, typer.Option("--holdout", help="Another recording of the axis, not fitted.")
    ] = None,
    json: JsonOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for model, figures and JSON.")] = None,
    without: Annotated[list[str] | None, typer.Option("--without", help="Effect not to try. Repeatable.")] = None,
    axis_name: AxisOption = None,
    mjcf: MjcfOption = None,
    joint: JointOption = None,
    at: AtOption = None,
    figures: FiguresOption = Figures.PNG,
) -> None:
    """Find where model and recording disagree, name the missing effects, and show the gap shrink."""
    from bench.diagnosis.diagnosis import diagnose as run_diagnosis
    from bench.effects.present import named
    from bench.files import held
    from bench.report.diagnosis import SCHEMA, diagnosis, diagnosis_json, write_diagnosis
    from bench.report.provenance import provenance
    from bench.report.terminal import progress

    of = subject(rig, axis_name, mjcf, joint, at)
    axis, read = of.rig, of.read
    excluded = frozenset(named(name, "--without").name for name in without or [])
    other = read(holdout) if holdout else None
    names = in_a_row(traces)
    with refusal_as_json(json, SCHEMA), progress(f"diagnosing {names}") as done:
        recordings = [read(trace) for trace in traces]
        found = run_diagnosis(recordings, axis, other, excluded, done)
    options = {"without": sorted(excluded)} | ({"joint": joint, "at": at or []} if of.robot else {})
    basis = provenance(rig, traces, options, holdout, mjcf)
    title, files = f"{axis.name}: {names}", []
    with nullcontext() if out is None else held(out):
        if out is not None:
            files = write_diagnosis(out, found, title, basis, figures.ending)
        if json is not None:
            write_json(json, diagnosis_json(found, basis))
    tell(diagnosis(found, title, basis), files, json)
