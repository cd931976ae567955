"""`python -m tests.coverage --out docs/coverage.md`: how often `identify`'s intervals hold the truth."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated

import typer

from tests.blind.__main__ import workers
from tests.blind.draw import draw
from tests.blind.record import home, recorded
from tests.coverage.draw import recordings
from tests.coverage.run import of_blind, of_nulls
from tests.coverage.table import markdown

Count = Annotated[int, typer.Option(min=0)]
NOTE = """Recordings of the independent integrator (`tests/independent`). `told`: recordings that tell the quantity
by themselves; a run in one direction tells inertia and viscous friction only. Intervals of 80 and 50 % are those of
95 % scaled as a normal distribution's; 2.0 in the last column is a normal distribution's of 95 %."""


def main(
    count: Annotated[int, typer.Option(min=1, help="Recordings of each motion.")] = 60,
    singles: Count = 252,
    pairs: Count = 60,
    seed: int = 1,
    duration: Annotated[float, typer.Option(help="Of a null, about - s.")] = 6.0,
    jobs: Annotated[int, typer.Option(min=1)] = 2,
    out: Annotated[Path | None, typer.Option(help="File for the table.")] = None,
) -> None:
    """Coverage of nominal 95, 80 and 50 %: nulls over all motions, and axes that lack an effect or two."""
    known = recordings(count, seed, duration)
    with ProcessPoolExecutor(jobs, get_context("spawn")) as pool:
        nulls = dict(zip(known, pool.map(of_nulls, known.values()), strict=True))
    parts = [markdown("Axes that lack nothing, by motion", nulls)]
    counts = {"single": singles, "pair": pairs}
    if singles + pairs:
        with workers(jobs) as pool:
            list(recorded(home(seed, 8.0, None), draw(seed, counts, 8.0), seed, pool))
        parts.append(markdown("Axes that lack what the model has not, by what is hidden", of_blind(counts, seed, 8.0)))
    command = f"python -m tests.coverage --count {count} --singles {singles} --pairs {pairs} --seed {seed}"
    text = "\n\n".join(["# Coverage of intervals", f"`{command}`", NOTE, *parts]) + "\n"
    typer.echo(text)
    if out is not None:
        out.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    typer.run(main)
