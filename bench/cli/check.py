"""`bench check`."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bench.cli.common import (
    STDOUT,
    AxisOption,
    JsonOption,
    ReportOption,
    list_files,
    refusal_as_json,
    tell,
    warn,
    write_json,
    write_page,
)
from bench.errors import InputError
from bench.files import keeping, require_writable, write_text
from bench.names import in_a_row, readable

if TYPE_CHECKING:
    from bench.baseline.check import Checked
    from bench.baseline.observe import Observed
    from bench.baseline.state import State
    from bench.rig.rig import Rig

#: Exit status of each result.
STATUS = {"same": 0, "changed": 3, "undecided": 1}


class Format(StrEnum):
    """How results reach whoever reads them."""

    TEXT = "text"
    GITHUB = "github"
    GITLAB = "gitlab"


def check(
    baseline: Annotated[Path, typer.Option("--baseline", help="TOML file of what the axis was.")],
    traces: Annotated[
        list[Path] | None, typer.Argument(metavar="TRACE...", help="Recordings of the axis now, of any known format.")
    ] = None,
    rig: Annotated[Path | None, typer.Option("--rig", help="Rig file (TOML): what is known about the axis.")] = None,
    simulated: Annotated[
        Path | None, typer.Option("--simulated", help="model.toml to check in the place of recordings.")
    ] = None,
    update: Annotated[bool, typer.Option("--update", help="Accept the present state: write the baseline.")] = False,
    without_names: Annotated[
        bool, typer.Option("--without-names", help="With --update: compare parameters alone, in a tenth of the time.")
    ] = False,
    junit: Annotated[Path | None, typer.Option("--junit", help="JUnit XML to write.")] = None,
    json: JsonOption = None,
    report: ReportOption = None,
    form: Annotated[
        Format, typer.Option("--format", help="github: annotations. gitlab: a code quality report on standard output.")
    ] = Format.TEXT,
    false_alarm_rate: Annotated[
        float, typer.Option("--false-alarm-rate", help="Of all comparisons together.", min=1e-6, max=0.5)
    ] = 0.01,
    axis_name: AxisOption = None,
) -> None:
    """Has this axis, or this model of one, changed? Exit status 0: the same, 3: changed, 1: undecided."""
    asked = Asked(traces or [], rig, simulated, baseline, axis_name)
    _require_consistent(asked, update, without_names, [path for path in (junit, json, report) if path is not None])
    with keeping(asked.inputs if update else [*asked.inputs, baseline]):
        for path in (junit, json, report, baseline if update else None):
            if path is not None and path != STDOUT:
                require_writable(path)
        if update:
            _update(asked, not without_names)
            return
        with refusal_as_json(json, "bench.check/1"):
            checked = asked.checked(false_alarm_rate)
        _write(checked, asked, junit, json, report, form)
    raise typer.Exit(STATUS[checked.result])


@dataclass(frozen=True)
class Asked:
    """What is to be held against what: recordings with their rig, or a model."""

    traces: list[Path]
    rig: Path | None
    simulated: Path | None
    baseline: Path
    axis_name: str | None

    @property
    def inputs(self) -> list[Path]:
        """Files that are read whatever is asked."""
        return [*self.traces, *(path for path in (self.rig, self.simulated) if path is not None)]

    @property
    def title(self) -> str:
        """What stands above results."""
        if self.simulated is not None:  # all of which are named model.toml
            return f"{self.simulated} against {self.baseline}"
        return f"{in_a_row(self.traces)} against {readable(self.baseline.name)}"

    @property
    def axis(self) -> Rig | None:
        """The rig, if one is given."""
        from bench.rig.rig import load_rig

        return None if self.rig is None else load_rig(self.rig).on_axis(self.axis_name)

    def observed(self, names: bool) -> Observed:
        """What recordings tell now, with where it comes from."""
        from bench.baseline.observe import observe
        from bench.report.provenance import provenance
        from bench.report.terminal import progress
        from bench.trace.read import read

        axis = self.axis
        assert axis is not None
        assert self.rig is not None
        with progress(f"checking {in_a_row(self.traces)}") as done:
            observed = observe([read(trace, axis.trace) for trace in self.traces], axis, names, done)
        basis = provenance(self.rig, self.traces, {"names": names, "axis": self.axis_name})
        return replace(observed, state=replace(observed.state, provenance=basis))

    def of_model(self, model: Path, like: State | None = None) -> State:
        """What a model has, with where it comes from."""
        from bench import __version__
        from bench.baseline.model import modelled
        from bench.report.provenance import sha256

        basis = {"version": __version__, "model": {"file": str(model), "sha256": sha256(model)}}
        return replace(modelled(model, like), provenance=basis)

    def checked(self, rate: float) -> Checked:
        """The check."""
        from bench.baseline.check import Allowed, compare
        from bench.baseline.state import read_baseline

        if self.simulated is None:
            axis, before = self.axis, read_baseline(self.baseline)
            before.require_source("recordings", self.baseline)
            assert axis is not None
            allowed = Allowed.of(axis)
            return compare(before, self.observed(before.names), allowed, rate)
        from bench.baseline.model import compare_models, is_model

        before = self.of_model(self.baseline) if is_model(self.baseline) else read_baseline(self.baseline)
        before.require_source("model", self.baseline)
        now = self.of_model(self.simulated, before)
        return compare_models(before, now, Allowed.of(self.axis, now.kind))


def _require_consistent(asked: Asked, update: bool, quick: bool, written: list[Path]) -> None:
    """InputError where arguments contradict each other, or one is missing."""
    if asked.simulated is not None and asked.traces:
        raise InputError("--simulated", "found with recordings", "allowed: a model, or recordings with their rig")
    if asked.simulated is None and not asked.traces:
        raise InputError("TRACE...", "found none", "allowed: recordings with --rig RIG, or --simulated MODEL")
    if asked.simulated is None and asked.rig is None:
        raise InputError("--rig", "missing", "give the rig file of the axis")
    if quick and not (update and asked.traces):
        found = "found without --update TRACE..."
        raise InputError("--without-names", found, "allowed: when the baseline is made, which says so from then on")
    if update and written:
        raise InputError(
            "--update", "found with --junit, --json or --report", "allowed: alone; the check after it has results"
        )


def _update(asked: Asked, names: bool) -> None:
    """Accept the present state, and say what a check against it will not be able to tell."""
    from bench.baseline.state import write_baseline
    from bench.comparison.difference import ENOUGH

    state = asked.of_model(asked.simulated) if asked.simulated is not None else asked.observed(names).state
    write_baseline(asked.baseline, state)
    list_files([asked.baseline])
    count = len(asked.traces)
    if 0 < count < ENOUGH:
        told = "1 recording tells" if count == 1 else f"{count} recordings tell"
        advice = f"make the baseline of {ENOUGH} or more, or state it in [check.between] of the rig"
        warn([f"{told} little of how recordings of this axis differ, so defaults count (docs/check.md): {advice}"])


def _write(
    checked: Checked, asked: Asked, xml: Path | None, json: Path | None, report: Path | None, form: Format
) -> None:
    """Every result where it is asked for."""
    from bench.report.check import check_document, check_json, findings, headline
    from bench.report.continuous_integration import github_lines, github_summary, gitlab_report, junit

    document, found, says = check_document(checked, asked.title), findings(checked), headline(checked)
    if xml is not None:
        write_text(xml, junit(found, says, asked.title))
    if json is not None:
        write_json(json, check_json(checked))
    write_page(report, document)
    if form is Format.GITLAB:
        typer.echo(gitlab_report(found, asked.baseline))
    elif json != STDOUT:
        with _no_commands(form):
            tell(document, (xml, json, report))
    if form is Format.GITHUB:
        for line in github_lines(found, asked.baseline):
            typer.echo(line)
        _append_summary(github_summary(found, says, asked.title))


@contextmanager
def _no_commands(form: Format) -> Iterator[None]:
    """Within the block GitHub takes no line for a workflow command, whatever a file is named."""
    token = secrets.token_hex(16)
    if form is Format.GITHUB:
        typer.echo(f"::stop-commands::{token}")
    try:
        yield
    finally:
        if form is Format.GITHUB:
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
