"""What reading costs beside pyarrow's own: `python -m tests.trace.reading_speed --rows 10000000`.

A recording of time, position, velocity and current is written once as Parquet and as CSV into the temporary folder and
read by both in turn, twice; the second reading counts, with the file in cache.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
import typer

from bench.trace.read import read


def recording(rows: int) -> pa.Table:
    """A swing at 1 kHz, rounded as recorders round."""
    seconds = 1e-3 * np.arange(rows)
    turn = 2.0 * np.pi * 0.7 * seconds
    return pa.table(
        {
            "time [s]": seconds.round(3),
            "position [rad]": (20.0 * np.sin(turn)).round(6),
            "velocity [rad/s]": (88.0 * np.cos(turn)).round(5),
            "current [A]": (3.0 * np.cos(turn + 0.1)).round(5),
        }
    )


def second_of(work: Callable[[], object]) -> float:
    """Seconds of the second of two runs."""
    taken = 0.0
    for _ in range(2):
        start = time.perf_counter()
        work()
        taken = time.perf_counter() - start
    return taken


def main(rows: Annotated[int, typer.Option(min=1000)] = 10_000_000) -> None:
    """Print the ratios."""
    with tempfile.TemporaryDirectory() as folder:
        parquet, table = Path(folder) / "run.parquet", Path(folder) / "run.csv"
        content = recording(rows)
        pa.parquet.write_table(content, parquet)
        pa.csv.write_csv(content, table)
        del content
        for path, other in ((parquet, pa.parquet.read_table), (table, pa.csv.read_csv)):
            theirs, ours = second_of(lambda: other(path)), second_of(lambda: read(path))  # noqa: B023
            typer.echo(
                f"{path.suffix[1:]}, {rows} rows: {ours:.2f} s, pyarrow {theirs:.2f} s, {ours / theirs:.2f} times"
            )


if __name__ == "__main__":
    typer.run(main)
