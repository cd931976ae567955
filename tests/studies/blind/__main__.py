"""Command line of the blind set."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from fnmatch import fnmatch
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

from bench.report.diagnosis import diagnosis
from bench.report.terminal import show as show_document
from tests.studies.blind.confusion import save_confusion
from tests.studies.blind.draw import Drawn, draw
from tests.studies.blind.record import home, recorded, truth_of
from tests.studies.blind.run import diagnosis_of, outcome
from tests.studies.blind.score import Score, score, twins
from tests.studies.blind.table import cases_csv, headline, markdown, wrong

Count = Annotated[int, typer.Option(min=0)]


@contextmanager
def workers(jobs: int) -> Iterator[Executor]:
    """Processes with one numeric thread each; several would fight over the cores."""
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(jobs, get_context("spawn")) as pool:
        yield pool


def scored(
    folder: Path, drawn: list[Drawn], seed: int, jobs: int, without_truth: bool = False, show: bool = True
) -> list[Score]:
    """Record what is missing, diagnose all, judge them; in the order drawn."""
    scores: dict[str, Score] = {}
    with workers(jobs) as pool, Progress(console=Console(stderr=True), disable=not show) as progress:
        bar = progress.add_task("recording", total=len(drawn))
        for done in recorded(folder, drawn, seed, pool):
            progress.advance(bar, done)
        truths = {case.name: truth_of(folder, case.name) for case in drawn}
        bar = progress.add_task("diagnosing", total=len(drawn))
        tasks = {
            pool.submit(outcome, folder / name, left_out(truth["effects"], without_truth)): name
            for name, truth in truths.items()
        }
        for task in as_completed(tasks):
            name = tasks[task]
            scores[name] = score(name, truths[name], task.result(), without_truth)
            progress.advance(bar)
    return [scores[case.name] for case in drawn]


def left_out(effects: list[str], without_truth: bool) -> frozenset[str]:
    """Names taken out of the catalogue: what is hidden, and what no recording tells from it."""
    return frozenset().union(*(twins(effect) for effect in effects)) if without_truth else frozenset()


def tell(folder: Path, name: str, without_truth: bool) -> None:
    """One case in full: truth, diagnosis, gap over noise floor after each addition."""
    truth, console = truth_of(folder, name), Console()
    console.print(truth)
    found = diagnosis_of(folder / name, left_out(truth["effects"], without_truth))
    show_document(diagnosis(found, str(folder / name)))
    for step in found.steps:
        console.print(
            f"{step.effect or 'bare axis'}: {step.torque[0] / found.torque.noise_floor:.3f} of the noise floor"
        )
    for place in found.unexplained_where:
        console.print(place.coordinate, place.region, f"{place.share:.2f}")


def main(
    singles: Count = 252,
    pairs: Count = 60,
    nulls: Count = 100,
    outside: Count = 32,
    crowds: Annotated[int, typer.Option(min=0, help="Of three to six effects.")] = 0,
    seed: int = 1,
    duration: Annotated[float, typer.Option(help="Of the first recording, about - s.")] = 8.0,
    jobs: Annotated[int, typer.Option(min=1)] = 2,
    without_truth: Annotated[bool, typer.Option(help="Take hidden effects out of the catalogue.")] = False,
    only: Annotated[str, typer.Option(help="Cases or effects whose name matches, as single-05* or backlash.")] = "*",
    out: Annotated[Path | None, typer.Option(help="Folder for confusion.png, table.md, cases.csv.")] = None,
    verbose: Annotated[bool, typer.Option(help="Print each case's truth and diagnosis.")] = False,
) -> None:
    """Hide effects in recordings of an independent integrator and see what the diagnosis makes of them."""
    counts = {"single": singles, "pair": pairs, "null": nulls, "outside": outside, "crowd": crowds}
    drawn = [
        case
        for case in draw(seed, counts, duration)
        if fnmatch(case.name, only) or any(fnmatch(effect.name, only) for effect in case.hidden.effects)
    ]
    if not drawn:
        raise typer.BadParameter(f"no case matches {only}")
    folder = home(seed, duration, None)
    scores = scored(folder, drawn, seed, jobs, without_truth)
    typer.echo(headline(scores) + "\n\n" + wrong(scores))
    typer.echo(f"recordings: {folder}", err=True)
    if verbose:
        for case in drawn:
            tell(folder, case.name, without_truth)
    if out is not None:
        options = [
            f"--seed {seed}",
            *(f"--{name}s {count}".replace("outsides", "outside") for name, count in counts.items()),
        ]
        options += [f"--only '{only}'"] * (only != "*") + ["--without-truth"] * without_truth
        write(
            out,
            scores,
            f"python -m tests.studies.blind {' '.join(options)} --duration {duration:g}",
            seed,
            without_truth,
        )


def write(out: Path, scores: list[Score], command: str, seed: int, without_truth: bool) -> None:
    """Figure, table and cases into a folder."""
    out.mkdir(parents=True, exist_ok=True)
    what = "with the hidden effect taken out of the catalogue" if without_truth else "all effects in the catalogue"
    save_confusion(out / "confusion.png", scores, f"Blind set, seed {seed}: {what}", without_truth)
    (out / "table.md").write_text(markdown(scores, f"Blind set, {what}", command), encoding="utf-8")
    (out / "cases.csv").write_text(cases_csv(scores), encoding="utf-8")


if __name__ == "__main__":
    typer.run(main)
