"""Command line of the blind set."""

from __future__ import annotations

from fnmatch import fnmatch
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from bench.report.diagnosis import diagnosis
from bench.report.terminal import show as show_document
from tests.studies.blind.confusion import save_confusion
from tests.studies.blind.draw import Drawn, draw
from tests.studies.blind.record import home, recorded, truth_of
from tests.studies.blind.run import diagnosis_of, outcome
from tests.studies.blind.score import Score, score, twins
from tests.studies.blind.table import cases_csv, headline, markdown, wrong
from tests.studies.frame import publish, running

Count = Annotated[int, typer.Option(min=0)]


def scored(
    folder: Path, drawn: list[Drawn], seed: int, jobs: int, without_truth: bool = False, show: bool = True
) -> list[Score]:
    """Record what is missing, diagnose all, judge them; in the order drawn."""
    with running(jobs, show) as run:
        run.counted("recording", len(drawn), recorded(folder, drawn, seed, run.pool))
        truths = [truth_of(folder, case.name) for case in drawn]
        asked = [
            (folder / case.name, left_out(truth["effects"], without_truth))
            for case, truth in zip(drawn, truths, strict=True)
        ]
        outcomes = run.each("diagnosing", outcome, asked)
    return [score(case.name, *one, without_truth) for case, *one in zip(drawn, truths, outcomes, strict=True)]


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
    publish(out, {"table.md": markdown(scores, f"Blind set, {what}", command), "cases.csv": cases_csv(scores)})


if __name__ == "__main__":
    typer.run(main)
