"""Command line of the mutation run."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from fnmatch import fnmatch
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

from tests.studies.mutation.mutants import Mutant, mutants
from tests.studies.mutation.run import Result, tried

SURVIVED, UNFINISHED = "SURVIVED", "TIME RAN OUT"


def results(chosen: Sequence[Mutant], jobs: int, deadline: float) -> list[Result]:
    """What became of each, in the order given."""
    found: dict[str, Result] = {}
    with ThreadPoolExecutor(jobs) as pool, Progress(console=Console(stderr=True)) as progress:
        bar = progress.add_task("mutants", total=len(chosen))
        tasks = [pool.submit(tried, mutant, mutant.stages, deadline) for mutant in chosen]
        for task in as_completed(tasks):
            result = task.result()
            found[result.name] = result
            progress.advance(bar)
            if not result.killed_by:
                progress.console.print(f"{fate(result)}: {result.name}")
    return [found[mutant.name] for mutant in chosen]


def markdown(found: Sequence[Result], command: str) -> str:
    """The table."""
    killed = sum(bool(result.killed_by) for result in found)
    late = sum(result.unfinished for result in found)
    lines = [
        "# Mutation run",
        "",
        "Each rule, doubt and judge switched off; each column of each effect turned in sign, or dropped; each property",
        "of an effect set to the neutral one, each method replaced by it. A mutant is killed by the first test that",
        f"fails with it. `{command}`",
        "",
        f"{len(found)} mutants: {killed} killed, {len(found) - killed - late} survived, {late} ran out of time.",
        "",
        "| mutant | killed by | s |",
        "|---|---|---|",
    ]
    lines += [f"| {result.name} | {fate(result)} | {result.seconds:.0f} |" for result in found]
    return "\n".join(lines) + "\n"


def fate(result: Result) -> str:
    """The test that killed it, or that none did."""
    return f"`{result.killed_by}`" if result.killed_by else f"**{UNFINISHED if result.unfinished else SURVIVED}**"


def main(
    only: Annotated[str, typer.Option(help="Mutants whose name matches, as 'cogging_torque*' or 'rule*'.")] = "*",
    jobs: Annotated[int, typer.Option(min=1)] = 2,
    deadline: Annotated[
        float, typer.Option(min=1.0, help="Per mutant - s; one that takes longer counts as alive.")
    ] = 300.0,
    baseline: Annotated[bool, typer.Option(help="First see that the tests pass without a mutant.")] = True,
    listed: Annotated[bool, typer.Option("--list", help="List the mutants and stop.")] = False,
    out: Annotated[Path | None, typer.Option(help="Folder for mutation.md.")] = None,
) -> None:
    """Change the bench in one place at a time and see that a test fails."""
    chosen = [mutant for name, mutant in mutants().items() if fnmatch(name, only)]
    if not chosen:
        raise typer.BadParameter(f"no mutant matches {only}")
    if listed:
        typer.echo("\n".join(mutant.name for mutant in chosen))
        return
    if baseline:
        files = dict.fromkeys(path for mutant in chosen for stage in mutant.stages for path in stage)
        stage = tuple(path for path in files if path.startswith("/"))
        broken = tried(None, (stage,), 60.0 * deadline).killed_by
        if broken:
            raise typer.BadParameter(f"{broken} fails without a mutant")
    found = results(chosen, jobs, deadline)
    told = markdown(found, "python -m tests.studies.mutation" + (f" --only '{only}'" if only != "*" else ""))
    typer.echo(told)
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        (out / "mutation.md").write_text(told, encoding="utf-8")
    raise typer.Exit(any(not result.killed_by for result in found))


if __name__ == "__main__":
    typer.run(main)
