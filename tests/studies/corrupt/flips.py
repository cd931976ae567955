"""`python -m tests.studies.corrupt.flips --count 10000`: one bit flipped in files of each format that is read.

Files are read in a process beside this one. What is neither a recording nor a refusal in one line ends the study, as do
a warning and a file that takes longer than its deadline or too much memory; that file lies in the working folder then.
"""

from __future__ import annotations

import tempfile
import warnings
from collections import Counter
from importlib import import_module
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

import bench
from bench.errors import BenchError
from bench.jobs.process import Failure, Limits, WorkerProcess
from tests.hostile import columns
from tests.studies.corrupt import files

#: Samples of a recording: few, so that as many flips fall upon what describes them as upon themselves.
SAMPLES = 60
OUTCOMES = ("refused", "told", "as it was", "another number", "ended its process")
#: Formats with sums of all that is read: no number of theirs may come out as another one.
SUMMED = ("npz", "mcap", "h5 with sums", "parquet with sums")
#: Read by a library whose end is foreseen: the bench gives it a process of its own.
APART = ("mf4",)
LIMITS = Limits(deadline=30.0, memory=2.0 * 1024**3)


def read(item: tuple[str, str]) -> str | tuple[tuple[str, ...], list[np.ndarray]]:
    """Notes and samples of a file of a format, or the line in which it is refused."""
    warnings.simplefilter("error")
    path, kept = item
    try:
        trace = bench.read(path, files.COLUMNS.get(kept.split()[0], files.PLAIN))
    except BenchError as error:
        return str(error)
    return tuple(trace.notes), [trace.time, trace["velocity"], trace["current"]]


def flipped(kept: str, count: int, seed: int, folder: Path) -> Counter[str]:
    """Outcomes of so many files, each with one bit flipped."""
    rng, found = np.random.default_rng(seed), Counter[str]()
    content = {**files.KEPT, **files.SUMMED}[kept](columns(SAMPLES))
    path = folder / f"run.{kept.split()[0]}"
    path.write_bytes(content)
    with WorkerProcess(read, LIMITS) as process:
        good = process.do((str(path), kept))
        for _ in range(count):
            path.write_bytes(changed := files.bit(rng, content))
            what = outcome(process.do((str(path), kept)), good)
            if what not in OUTCOMES or (what == OUTCOMES[-1] and kept not in APART):
                Path("input").write_bytes(changed)
                raise AssertionError(f"{kept}: {what}")
            found[what] += 1
    return found


def outcome(now: object, good: object) -> str:
    """One of OUTCOMES, or what happened that must not."""
    if isinstance(now, Failure):
        return OUTCOMES[-1] if "worker was killed" in now.reason else now.reason
    if isinstance(now, str):
        return "refused" if "\n" not in now else now
    assert isinstance(now, tuple) and isinstance(good, tuple)
    if now[0] != good[0]:
        return "told"
    same = all(np.array_equal(one, other, equal_nan=True) for one, other in zip(now[1], good[1], strict=True))
    return "as it was" if same else "another number"


def main(
    count: Annotated[int, typer.Option(help="Of each format.")] = 10_000,
    seed: Annotated[int, typer.Option(help="Of the bits.")] = 0,
    only: Annotated[str, typer.Option(help="Formats whose name holds this.")] = "",
) -> None:
    """Flip bits, read, and count what became of it."""
    typer.echo(f"| format | {' | '.join(OUTCOMES)} |\n|{'---|' * (len(OUTCOMES) + 1)}")
    with tempfile.TemporaryDirectory() as place:
        for kept in (name for name in (*files.KEPT, *files.SUMMED) if only in name):
            found = flipped(kept, count, seed, Path(place))
            typer.echo(f"| {kept} | {' | '.join(str(found[what]) for what in OUTCOMES)} |")


if __name__ == "__main__":
    typer.run(import_module("tests.studies.corrupt.flips").main)  # whose name the other process finds
