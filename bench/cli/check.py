"""`bench check`."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

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
    baseline: Annotated[Path, typer.Option("--baseline", help="TOML file of what the axis was.")],
    traces: Annotated[
        list[Path] | None, typer.Argument(metavar="TRACE...", help="Recordings of the axis now, of any known format.")
    ] = None,
    rig: common.OptionalRigOption = None,
    simulated: Annotated[
        Path | None, typer.Option("--simulated", help="model.toml to check in the place of recordings.")
    ] = None,
    update: Annotated[bool, typer.Option("--update", help="Accept the present state: write the baseline.")] = False,
    without_names: Annotated[
        bool, typer.Option("--without-names", help="With --update: compare parameters alone, in a tenth of the time.")
    ] = False,
    junit: Annotated[Path | None, typer.Option("--junit", help="JUnit XML to write.")] = None,
    json: common.JsonOption = None,
    report: common.ReportOption = None,
    form: Annotated[
        Format, typer.Option("--format", help="github: annotations. gitlab: a code quality report on standard output.")
    ] = "text",
    false_alarm_rate: Annotated[
        float, typer.Option("--false-alarm-rate", help="Of all comparisons together.", min=1e-6, max=0.5)
    ] = 0.01,
    axis_name: common.AxisOption = None,
    mjcf: common.MjcfOption = None,
    joint: common.JointOption = None,
    at: common.AtOption = None,
) -> None:
    """Has this axis, or this model of one, changed? Exit status 0: the same, 3: changed, 1: undecided."""
    asked = Asked(traces or [], rig, simulated, axis_name, mjcf, joint or [], at or [])
    _require_consistent(asked, update, without_names, any((junit, json, report)))
    if update:
        _update(asked, baseline, not without_names)
        return
    with common.refusal_as_json(json, "bench.check/1"):
        checked = asked.checked(baseline, false_alarm_rate)
    if simulated is not None:  # all of which are named model.toml
        title = f"{simulated} against {baseline}"
    else:
        title = f"{in_a_row(asked.traces)} against {readable(baseline.name)}"
    _write(checked, title, baseline, (junit, json, report), form)
    raise typer.Exit(STATUS[checked.result])


@dataclass(frozen=True)
class Asked:
    """What is to be held against the baseline: recordings with their rig, or a model."""

    traces: list[Path]
    rig: Path | None
    simulated: Path | None
    axis_name: str | None
    mjcf: Path | None
    joints: list[str]
    at: list[str]

    @cached_property
    def subject(self) -> Subject:
        """What the recordings are of."""
        return common.subject(self.rig, self.axis_name, self.mjcf, self.joints, self.at, self.traces[0])

    def observed(self, names: bool) -> Observed:
        """What recordings tell now, with where it comes from."""
        from bench.baseline.observe import observe
        from bench.report.parts import provenance
        from bench.report.terminal import progress

        of = self.subject
        with progress(f"checking {in_a_row(self.traces)}") as done:
            observed = observe([of.read(trace) for trace in self.traces], of.rig, names, done)
        options = {"names": names, "axis": self.axis_name, **of.options}
        basis = provenance(self.rig, self.traces, options, None, self.mjcf)
        return replace(observed, state=replace(observed.state, provenance=basis))

    def checked(self, baseline: Path, rate: float) -> bench.Checked:
        """The check."""
        from bench.baseline.check import Allowed, compare
        from bench.baseline.state import read_baseline

        if self.simulated is None:
            before = read_baseline(baseline)
            before.require_source("recordings", baseline)
            return compare(before, self.observed(before.names), Allowed.of(self.subject.rig), rate)
        from bench.baseline.model import compare_models, is_model

        before = _of_model(baseline) if is_model(baseline) else read_baseline(baseline)
        before.require_source("model", baseline)
        now = _of_model(self.simulated, before)
        rig = None if self.rig is None else bench.load_rig(self.rig).on_axis(self.axis_name)
        return compare_models(before, now, Allowed.of(rig, now.kind))


def _of_model(model: Path, like: State | None = None) -> State:
    """What a model has, with where it comes from."""
    from bench.baseline.model import modelled

    basis = {"version": bench.__version__, "model": {"file": str(model), "sha256": sha256(model)}}
    return replace(modelled(model, like), provenance=basis)


def _require_consistent(asked: Asked, update: bool, quick: bool, written: bool) -> None:
    """InputError where arguments contradict each other, or one is missing."""
    if asked.simulated is not None and asked.traces:
        raise InputError("--simulated", "found with recordings", "allowed: a model, or recordings with their rig")
    if asked.simulated is None and not asked.traces:
        raise InputError("TRACE...", "found none", "allowed: recordings with --rig RIG, or --simulated MODEL")
    if asked.simulated is not None and (asked.mjcf or asked.joints or asked.at):
        raise InputError("--simulated", "found with --mjcf, --joint or --at", "allowed: with recordings")
    if asked.simulated is None and asked.rig is None and asked.mjcf is None:
        allowed = "give the rig file of the axis, or the name of a shipped rig; or --mjcf and --joint"
        raise InputError("--rig", "missing", allowed)
    if quick and not (update and asked.traces):
        found = "found without --update TRACE..."
        raise InputError("--without-names", found, "allowed: when the baseline is made, which says so from then on")
    if update and written:
        raise InputError(
            "--update", "found with --junit, --json or --report", "allowed: alone; the check after it has results"
        )


def _update(asked: Asked, baseline: Path, names: bool) -> None:
    """Accept the present state, and say what a check against it will not be able to tell."""
    from bench.baseline.state import write_baseline
    from bench.comparison.difference import ENOUGH

    simulated = asked.simulated
    state = asked.observed(names).state if simulated is None else _of_model(simulated)
    write_baseline(baseline, state)
    common.list_files([baseline])
    count = len(asked.traces)
    if 0 < count < ENOUGH:
        counted = "1 recording tells" if count == 1 else f"{count} recordings tell"
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
