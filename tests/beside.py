"""Seconds of CPU a diagnosis, this checkout beside another, case by case in turn: `python -m tests.beside OTHER`."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import track

from tests.shared import SHARED

HERE = Path(__file__).resolve().parents[1]


def seconds(checkout: Path, case: Path) -> float:
    """User and system time of `bench diagnose` on a case, of a whole process with one numeric thread."""
    files = [str(case / name) for name in ("run1.csv.gz", "rig.toml", "run2.csv.gz")]
    command = [sys.executable, "-m", "bench", "diagnose", files[0], "--rig", files[1], "--holdout", files[2]]
    one = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(checkout)}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, env=os.environ | one, cwd=checkout, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(
    other: Annotated[Path, typer.Argument(help="Another checkout of the project.")],
    every: Annotated[int, typer.Option(min=1, help="Take every so many of the shared cases.")] = 1,
) -> None:
    """Diagnose the shared cases with both checkouts in turn; print seconds and their ratio."""
    cases = sorted(path for path in (SHARED / "cases").iterdir() if path.is_dir())[::every]
    taken = track(cases, console=Console(stderr=True))
    rows = [(seconds(HERE, case), seconds(other.resolve(), case)) for case in taken]
    here, there = np.array(rows).T
    for case, mine, its in zip(cases, here, there, strict=True):
        typer.echo(f"{case.name}: {mine:.2f} s here, {its:.2f} s there, ratio {mine / its:.2f}")
    typer.echo(f"all: {here.sum():.1f} s here, {there.sum():.1f} s there, ratio {here.sum() / there.sum():.3f}")
    typer.echo(f"median ratio {np.median(here / there):.3f}, of {len(cases)} cases")


if __name__ == "__main__":
    typer.run(main)
