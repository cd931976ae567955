"""`bench fleet`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bench import __version__
from bench.cli.common import STDOUT, JsonOption, say, tell, write_json
from bench.errors import UndeterminedError

if TYPE_CHECKING:
    from bench.fleet.fleet import Fleet

SUMMARY = "summary.json"


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
    from bench.files import keeping, sha256, write_text
    from bench.fleet.fleet import TABLE
    from bench.fleet.fleet import fleet as run_fleet
    from bench.jobs.process import Limits
    from bench.report.fleet import fleet_document, fleet_json
    from bench.report.publish import write_html
    from bench.report.terminal import progress

    limits = Limits(deadline, memory * 1024**3)
    basis = {"version": __version__, "manifest_sha256": sha256(manifest), "options": {"diagnose": diagnose}}
    page = out / "fleet.html"

    def write_document(found: Fleet) -> None:
        with keeping(found.manifest.inputs):
            write_text(out / SUMMARY, fleet_json(found, basis) + "\n")
            write_html(page, fleet_document(found, SUMMARY, basis))

    with progress(f"evaluating {manifest.name}") as done:
        found = run_fleet(manifest, out, diagnose, retry, limits, workers, scheduler, done, write_document)
    if json is not None:
        write_json(json, fleet_json(found, basis))
    tell(fleet_document(found, SUMMARY, basis), (out / TABLE, out / SUMMARY, page), json)
    if json != STDOUT:
        say(f"{found.evaluated} evaluated now")
    if not found.summary.counts["done"]:
        reason = f"none of {len(found.manifest)} recordings gave a result"
        raise UndeterminedError("the fleet", reason, f"what the column `reason` of {out / TABLE} asks for")
