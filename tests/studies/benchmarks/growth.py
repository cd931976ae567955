"""How time grows with samples and with effects."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bench.axis_kind import COULOMB
from bench.effects.catalogue import catalogue
from bench.effects.effect import Coupling
from bench.effects.torque import Friction
from bench.fit.estimate import Estimate
from bench.fit.hypothesis import Hypothesis, Layout, Term, lay_out
from bench.fit.identify import identify
from bench.fit.rows import Memory, Rows
from bench.plant.run import run
from bench.trace.read import read
from bench.trace.stream import stream
from tests.effects.axes import VALUES, Reversals, plant
from tests.fit.motions import RIG, recording
from tests.studies.benchmarks.table import Table, growth
from tests.studies.benchmarks.timing import Way, in_turn


def measured(
    samples: Sequence[int] = (1_000, 10_000, 100_000, 1_000_000, 10_000_000),
    effects: Sequence[int] = (1, 3, 7, 14, 21),
    ticks: int = 2000,
    rounds: int = 3,
) -> list[Table]:
    """Time over each of these sizes."""
    return [by_samples(samples, rounds), by_effects(effects, ticks, rounds)]


def by_samples(sizes: Sequence[int], rounds: int) -> Table:
    """`identify` of a Parquet file at 1 kHz, read whole and streamed; the longest only streamed."""
    with tempfile.TemporaryDirectory() as folder:
        paths = {size: written(Path(folder), size) for size in sizes}
        streamed = in_turn({str(size): partial(by_stream, path) for size, path in paths.items()}, rounds)
        read_whole = {str(size): partial(by_read, path) for size, path in paths.items() if size < WHOLE}
        together = in_turn(read_whole, rounds)
    parts, whole = [streamed.median(str(size)) for size in sizes], [together.median(size) for size in read_whole]
    rows = zip(
        (f"{size:.0e}" for size in sizes),
        (*(f"{seconds:.3g} s" for seconds in whole), *[""] * (len(sizes) - len(whole))),
        (*growth(sizes[: len(whole)], whole), *[""] * (len(sizes) - len(whole))),
        (f"{seconds:.3g} s" for seconds in parts),
        growth(sizes, parts),
        strict=True,
    )
    says = (
        "`identify` from a Parquet file of time, velocity and current, read whole or streamed in bounded memory. The "
        "exponent is that of time over size, from the row above: 1 is proportional."
    )
    return Table(says, ("samples", "read whole", "exponent", "streamed", "exponent"), tuple(rows))


def written(folder: Path, size: int) -> Path:
    """Parquet file of so many samples at 1 kHz."""
    path = folder / f"{size}.parquet"
    trace = recording(np.random.default_rng(1), duration=size * 1e-3)
    signals = {"velocity [rad/s]": trace["velocity"], "current [A]": trace["current"]}
    pq.write_table(pa.table({"time [s]": trace.time, **signals}), path)
    return path


def by_stream(path: Path) -> Estimate:
    """`identify` of a file that is read as it is needed."""
    return identify(stream(path), RIG)


def by_read(path: Path) -> Estimate:
    """`identify` of a file that is read before."""
    return identify(read(path), RIG)


#: Samples from which on a recording is streamed only.
WHOLE = 10_000_000


def by_effects(sizes: Sequence[int], ticks: int, rounds: int) -> Table:
    """The first so many effects of the catalogue on one axis: simulated, and as columns of a hypothesis."""
    names, one = one_coupling(), plant()
    motion = Reversals(one.cascade.control_period * (ticks - 0.5)).references()
    rows_of_run = Rows.of(recording(np.random.default_rng(0), duration=8.0, position=True), RIG)
    simulated: dict[str, Way] = {str(n): partial(run, plant(*names[:n]), motion) for n in sizes}
    laid: dict[str, Way] = {str(n): partial(columns, rows_of_run, names[:n]) for n in sizes}
    times = [[timed.median(str(n)) for n in sizes] for timed in (in_turn(simulated, rounds), in_turn(laid, rounds))]
    rows = zip(
        map(str, sizes),
        (f"{1e6 * taken / ticks:.3g} us" for taken in times[0]),
        growth(sizes, times[0]),
        (f"{1e3 * taken:.3g} ms" for taken in times[1]),
        growth(sizes, times[1]),
        strict=True,
    )
    says = (
        "The first so many effects of the catalogue, one coupling among them, on one axis: a simulated tick, and the "
        "columns of a hypothesis that has all of them, of 8 s at 1 kHz, nothing kept from before."
    )
    return Table(says, ("effects", "simulated tick", "exponent", "columns", "exponent"), tuple(rows))


def one_coupling() -> list[str]:
    """Names of effects that one axis can have together, as they stand in the tests' table."""
    found, kinds, coupled = [], catalogue(), False
    for name in VALUES:
        if not (isinstance(kinds[name], Coupling) and coupled):
            found.append(name)
            coupled = coupled or isinstance(kinds[name], Coupling)
    return found


def columns(rows: Rows, names: Sequence[str]) -> Layout:
    """Columns of effects at the shapes that they are simulated with."""
    kinds = catalogue()
    terms = []
    found: dict[str | int, list[float]] = {COULOMB: [1.0]}
    for index, name in enumerate(names):
        effect = kinds[name]
        shape = tuple(shape.grid[len(shape.grid) // 2] if shape.grid else SHAPE for shape in effect.shapes)
        if isinstance(effect, Friction):
            found[index] = [0.5] * len(effect.columns(rows.stretches[0].signals, shape))
        terms.append(Term(effect, shape))
    return lay_out(replace(rows, memory=Memory()), Hypothesis(tuple(terms)), found)


#: Of a shape that has no grid.
SHAPE = 0.1
