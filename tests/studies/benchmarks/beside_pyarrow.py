"""Beside pyarrow's own reading: a recording of time, position, velocity and current, from a file in the page cache."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from bench.trace.read import read
from bench.trace.stream import stream
from tests.studies.benchmarks.table import Table
from tests.studies.benchmarks.timing import Way, in_turn


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


def streamed(path: Path) -> int:
    """Samples of a recording, read part by part and let go."""
    return sum(len(part) for part in stream(path))


def measured(sizes: Sequence[int] = (100_000, 1_000_000, 10_000_000), rounds: int = 5) -> list[Table]:
    """Recordings of so many rows."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        parquet, table = Path(folder) / "run.parquet", Path(folder) / "run.csv"
        for size in sizes:
            content = recording(size)
            pa.parquet.write_table(content, parquet)
            pa.csv.write_csv(content, table)
            del content
            assert len(read(parquet)) == len(read(table)) == streamed(parquet) == size
            ways: dict[str, dict[str, Way]] = {
                "Parquet": {
                    "pyarrow": partial(pa.parquet.read_table, parquet),
                    "read": partial(read, parquet),
                    "stream": partial(streamed, parquet),
                },
                "CSV": {"pyarrow": partial(pa.csv.read_csv, table), "read": partial(read, table)},
            }
            for form, those in ways.items():
                timed = in_turn(those, rounds)
                ratios = [f"{timed.ratio(way, 'pyarrow'):.2f}" if way in those else "" for way in ("read", "stream")]
                found.append((f"{form}, {size:.0e} rows", f"{timed.median('pyarrow'):.3g} s", *ratios))
    says = (
        "`read` gives a trace on one regular time base in SI units, every value looked at; `stream` the same part by "
        "part, in bounded memory. pyarrow's columns stay as they stand in the file."
    )
    return [Table(says, ("file", "pyarrow", "`read`, times that", "`stream`, times that"), tuple(found))]
