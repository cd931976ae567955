"""`bench check`."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from typer import Argument, Option

import bench
from bench.cli import common
from bench.errors import InputError
from bench.files import sha256, write_text
from bench.names import in_a_row, readable

if TYPE_CHECKING:
    from bench.baseline.observe import Observed
    from bench.baseline.state import State
    from bench.cli.common import Subject

#: Exit status of each result.
STATUS = {"same": 0, "changed": 3, "undecided": 1}
#: How results reach whoever reads them.
Format = Literal["text", "github", "gitlab"]


def check(
    baseline: Annotated[Path, Option(help="TOML file of what the axis was.")],
    traces: Annotated[
        list[Path] | None, Argument(metavar="TRACE", help="Recordings of the axis now, of any known format.")
    ] = None,
    rig: common.OptionalRigOption = None,
    simulated: Annotated[Path | None, Option(help="model.toml to check in the place of recordings.")] = None,
    update: Annotated[bool, Option("--update", help="Accept the present state: write the baseline.")] = False,
    without_names: Annotated[
        bool, Option("--without-names", help="With --update: compare only parameters, in a tenth of the time.")
    ] = False,
    junit: Annotated[Path | None, Option(help="JUnit XML to write.")] = None,
    json: common.JsonOption = None,
    report: common.ReportOption = None,
    form: Annotated[
        Format, Option("--format", help="github: annotations. gitlab: a code quality report on standard output.")
    ] = "text",
    false_alarm_rate: Annotated[float, Option(help="Of all comparisons together.", min=1e-6, max=0.5)] = 0.01,
    axis_name: common.AxisOption = None,
    mjcf: common.MjcfOption = None,
    joint: common.JointOption = None,
    at: common.AtOption = None,
) -> None:
    """Check whether an axis, or a model of one, has changed. Exit status 0: the same, 3: changed, 1: undecided."""
    given = traces or []
    selects_joint, no_rig = bool(mjcf or joint or at), rig is None and mjcf is None
    _require_consistent(given, simulated, selects_joint, no_rig, update, without_names, any((junit, json, report)))
    if simulated is None:
        of = common.subject(rig, axis_name, mjcf, joint, at, given[0])
        if update:
            _accept(baseline, _observed(of, given, axis_name, not without_names).state, len(given))
            return
        with common.refusal_as_json(json, "bench.check/1"):
            checked = _recordings_checked(baseline, of, given, axis_name, false_alarm_rate)
        title = f"{in_a_row(given)} against {readable(baseline.name)}"
    else:
        if update:
            _accept(baseline, _of_model(simulated))
            return
        checked = _model_checked(baseline, simulated, rig, axis_name)
        title = f"{readable(simulated)} against {readable(baseline)}"  # all of which are named model.toml
    _write(checked, title, baseline, (junit, json, report), form)
    raise typer.Exit(STATUS[checked.result])


def _require_consistent(
    traces: list[Path], simulated: Path | None, joint: bool, no_rig: bool, update: bool, quick: bool, written: bool
) -> None:
    """InputError where arguments contradict each other, or one is missing."""
    if simulated is not None and traces:
        raise InputError("--simulated", "found with recordings", "allowed: a model, or recordings with their rig")
    if simulated is None and not traces:
        raise InputError("TRACE...", "found none", "allowed: recordings with --rig RIG, or --simulated MODEL")
    if simulated is not None and joint:
        raise InputError("--simulated", "found with --mjcf, --joint or --at", "allowed: with recordings")
    if simulated is None and no_rig:
        allowed = "give the rig file of the axis, or the name of a shipped rig; or --mjcf and --joint"
        raise InputError("--rig", "missing", allowed)
    if quick and not (update and traces):
        found = "found without --update TRACE..."
        raise InputError("--without-names", found, "allowed: when the baseline is made; it then states this")
    if update and written:
        found = "found with --junit, --json or --report"
        raise InputError("--update", found, "allowed: no output of results; the next check has results")


def _observed(of: Subject, traces: list[Path], axis: str | None, names: bool) -> Observed:
    """The present state by recordings, with where it comes from."""
    from bench.baseline.observe import observe
    from bench.report.terminal import progress

    with progress(f"checking {in_a_row(traces)}") as done:
        observed = observe([of.read(trace) for trace in traces], of.rig, names, done)
    basis = of.provenance(traces, {"names": names, "axis": axis})
    return replace(observed, state=replace(observed.state, provenance=basis))


def _of_model(model: Path, like: State | None = None) -> State:
    """What a model has, with where it comes from."""
    from bench.baseline.model import modelled

    basis = {"version": bench.__version__, "model": {"file": str(model), "sha256": sha256(model)}}
    return replace(modelled(model, like), provenance=basis)


def _recordings_checked(
    baseline: Path, of: Subject, traces: list[Path], axis: str | None, rate: float
) -> bench.Checked:
    from bench.baseline.check import Allowed, compare
    from bench.baseline.state import read_baseline

    before = read_baseline(baseline)
    before.require_source("recordings", baseline)
    return compare(before, _observed(of, traces, axis, before.names), Allowed.of(of.rig), rate)


def _model_checked(baseline: Path, model: Path, rig: Path | None, axis: str | None) -> bench.Checked:
    from bench.baseline.check import Allowed
    from bench.baseline.model import compare_models, is_model
    from bench.baseline.state import read_baseline

    before = _of_model(baseline) if is_model(baseline) else read_baseline(baseline)
    before.require_source("model", baseline)
    now = _of_model(model, before)
    known = None if rig is None else bench.load_rig(rig).on_axis(axis)
    return compare_models(before, now, Allowed.of(known, now.kind))


def _accept(baseline: Path, state: State, recordings: int = 0) -> None:
    """Write the present state, and warn of what a check against it cannot determine."""
    from bench.baseline.state import write_baseline
    from bench.comparison.difference import ENOUGH

    write_baseline(baseline, state)
    common.list_files([baseline])
    if 0 < recordings < ENOUGH:
        counted = "1 recording determines" if recordings == 1 else f"{recordings} recordings determine"
        advice = f"make the baseline of {ENOUGH} or more, or state it in [check.between] of the rig"
        how = f"{counted} little of how recordings of this axis differ, so defaults count (docs/check.md)"
        common.warn([f"{how}: {advice}"])


def _write(
    checked: bench.Checked,
    title: str,
    baseline: Path,
    files: tuple[Path | None, Path | None, Path | None],
    form: Format,
) -> None:
    """Every result where it is asked for: JUnit's, JSON and page into their files."""
    from bench.report.check import check_document, check_json
    from bench.report.continuous_integration import github_lines, github_summary, gitlab_report, junit

    document, (xml, json, report) = check_document(checked, title), files
    if xml is not None:
        write_text(xml, junit(checked, title))
    common.write_json(json, lambda: check_json(checked))
    common.write_page(report, document)
    if form == "gitlab":
        typer.echo(gitlab_report(checked, baseline))
    elif json != common.STDOUT:
        with _no_commands(form):
            common.tell(document, files)
    if form == "github":
        for line in github_lines(checked, baseline):
            typer.echo(line)
        _append_summary(github_summary(checked, title))


@contextmanager
def _no_commands(form: Format) -> Iterator[None]:
    """Within the block GitHub takes no line for a workflow command, whatever a file is named."""
    if form != "github":
        yield
        return
    token = secrets.token_hex(16)
    typer.echo(f"::stop-commands::{token}")
    try:
        yield
    finally:
        typer.echo(f"::{token}::")


def _append_summary(text: str) -> None:
    path = os.environ.get("GITHUB_STEP_SUMMARY")
    if path:
        try:
            with Path(path).open("a", encoding="utf-8", errors="backslashreplace") as file:
                file.write(text)
        except OSError as error:
            found = f"cannot be written to ({error.strerror})"
            raise InputError(f"GITHUB_STEP_SUMMARY {path}", found, "name a file that can be written") from error
