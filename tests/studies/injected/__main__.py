"""Command line: put every effect into every recording at several strengths, diagnose, and tell what became of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, TypeVar

import typer
from rich.console import Console
from rich.progress import Progress

from bench.jobs.each import each
from bench.jobs.process import Failure, Limits
from tests.studies.frame import publish
from tests.studies.injected import stability
from tests.studies.injected.cases import (
    FAILED,
    UNABLE,
    Case,
    Known,
    Row,
    draw,
    itself,
    judged,
    keep,
    kept,
    kept_in,
    write_case,
)
from tests.studies.injected.sources import Source, real, simulated
from tests.studies.injected.table import markdown

T = TypeVar("T")
R = TypeVar("R")
#: For one case: many times what the slowest diagnosis takes - s. A process that dies is the failure of its case alone.
LIMITS = Limits(deadline=900.0)


def done(
    what: str,
    work: Callable[[T], R],
    items: Sequence[T],
    jobs: int,
    tell: Callable[[T, R | Failure], str],
) -> None:
    """Do work on all items side by side; each as it ends is told, on a line where that is not empty."""
    with Progress(console=Console(stderr=True)) as progress:
        bar = progress.add_task(what, total=len(items))
        for place, outcome in each(work, items, LIMITS, jobs):
            line = tell(items[place], outcome)
            if line:
                progress.console.print(line, markup=False, soft_wrap=True)
            progress.advance(bar)


def owns_of(sources: Sequence[Source], jobs: int) -> tuple[dict[str, Known], dict[str, str]]:
    """Of all sources, and why some are refused; in their order."""
    found: dict[str, Known] = {}
    refused: dict[str, str] = {}

    def tell(source: Source, outcome: Known | str | Failure) -> str:
        if isinstance(outcome, Known):
            found[source.name] = outcome
            return ""
        refused[source.name] = outcome.reason if isinstance(outcome, Failure) else outcome
        return f"{source.name}: {refused[source.name]}"

    done("recordings as they are", itself, sources, jobs, tell)
    names = [source.name for source in sources]
    return {name: found[name] for name in names if name in found}, refused


def rows_of(items: Sequence[tuple[Case, Source, Known]], path: Path, jobs: int) -> dict[str, Row]:
    """Rows of cases with their recordings, those that are kept already and the others."""
    asked = {case.name for case, *_ in items}
    rows = {row.case.name: row for row in kept(path) if row.case.name in asked}

    def tell(item: tuple[Case, Source, Known], outcome: Row | Failure) -> str:
        row = Row(item[0], FAILED, reason=outcome.reason) if isinstance(outcome, Failure) else outcome
        keep(path, row)
        rows[row.case.name] = row
        return row.line

    done("injected", judged, [item for item in items if item[0].name not in rows], jobs, tell)
    return rows


def all_sources(only: str, realistic: int, seed: int, jobs: int) -> list[Source]:
    """Real ones and as many simulated."""
    sources = [*real()]
    if realistic:
        sources += simulated(seed, realistic, jobs)
    return [source for source in sources if only in source.name]


def answers_of(sources: Sequence[Source], seed: int, jobs: int) -> dict[str, dict[str, stability.Answer | None]]:
    """Names of each recording as it is and varied; in their order."""
    said: dict[str, dict[str, stability.Answer | None]] = {}

    def tell(item: tuple[Source, int], outcome: dict[str, stability.Answer | None] | Failure) -> str:
        if isinstance(outcome, Failure):
            return f"{item[0].name}: {outcome.reason}"
        said[item[0].name] = outcome
        return f"{item[0].name}: " + "; ".join(
            f"{variant}: {answer or stability.REFUSED}" for variant, answer in outcome.items()
        )

    done("names", stability.answers, [(source, seed) for source in sources], jobs, tell)
    return {source.name: said[source.name] for source in sources if source.name in said}


def first(items: Sequence[tuple[Case, Source, Known]], count: int, path: Path, jobs: int) -> list[Row]:
    """Rows of the first so many cases that their axes can have, in the order in which they are drawn."""
    rows: list[Row] = []
    while len(rows) < len(items) and (lacking := count - sum(row.fate != UNABLE for row in rows)):
        more = items[len(rows) : len(rows) + lacking]
        found = rows_of(more, path, jobs)
        rows += [found[case.name] for case, *_ in more]
    return rows


def written(drawn: Sequence[Case], count: int, folder: Path, sources: dict[str, Source], owns: dict[str, Known]) -> int:
    """Write the first cases that their axes can have as folders; how many there are."""
    made = 0
    for case in drawn:
        if made < count:
            made += write_case(folder / f"injected-{made:03d}", case, sources[case.source], owns[case.source])
    return made


def main(
    only: Annotated[str, typer.Option(help="Recordings whose name holds this.")] = "",
    effect: Annotated[list[str] | None, typer.Option(help="Effects instead of all. Repeatable.")] = None,
    realistic: Annotated[int, typer.Option(min=0, help="Simulated axes of four to six small effects beside.")] = 12,
    seed: int = 1,
    jobs: Annotated[int, typer.Option(min=1)] = 2,
    out: Annotated[Path | None, typer.Option(help="Folder for table.md, or names.md.")] = None,
    stable: Annotated[bool, typer.Option("--stability", help="Instead: do names stay?")] = False,
    write: Annotated[Path | None, typer.Option(help="Instead: write cases as folders into this one.")] = None,
    cases: Annotated[int | None, typer.Option(min=1, help="First so many of those that their axes can have.")] = None,
) -> None:
    """Put every effect into every recording and see what the diagnosis makes of it."""
    sources = all_sources(only, realistic, seed, jobs)
    by_name = {source.name: source for source in sources}
    command = f"python -m tests.studies.injected --seed {seed} --realistic {realistic}" + f" --only {only}" * bool(only)
    command += "".join(f" --effect {name}" for name in effect or ()) + (f" --cases {cases}" if cases else "")
    if stable:
        told = stability.markdown(sources, answers_of(sources, seed, jobs), f"{command} --stability")
        typer.echo(told)
        publish(out, {"names.md": told})
        return
    owns, refused = owns_of(sources, jobs)
    chosen = draw(list(owns), effect or (), seed)
    if write is not None:
        typer.echo(f"{written(chosen, cases or len(chosen), write, by_name, owns)} cases in {write}")
        return
    items = [(case, by_name[case.source], owns[case.source]) for case in chosen]
    rows = first(items, cases or len(items), kept_in(seed), jobs)
    told = markdown(rows, by_name, owns, refused, command)
    typer.echo(told)
    publish(out, {"table.md": told})


if __name__ == "__main__":
    typer.run(main)
