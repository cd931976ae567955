"""Beside NumPy's `lstsq`: the core of `identify`, from columns to coefficients with all that a covariance needs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.axis_kind import OFFSET
from bench.fit.hypothesis import lay_out, plain
from bench.fit.rows import Rows
from bench.fit.solution import equations_of, solved
from tests.fit.motions import RIG, recording
from tests.studies.benchmarks.table import Table
from tests.studies.benchmarks.timing import in_turn

CORE, LSTSQ = "normal equations", "numpy.linalg.lstsq"


def measured(durations: Sequence[float] = (3.0, 30.0, 300.0), rounds: int = 15) -> list[Table]:
    """Recordings at 1 kHz of so many seconds."""
    found = []
    for duration in durations:
        rows = Rows.of(recording(np.random.default_rng(0), duration=duration), RIG)
        laid = lay_out(rows, plain(rows))

        def core() -> np.ndarray:
            whole = equations_of(rows, laid).only(lambda name: name != OFFSET)  # noqa: B023
            return solved(whole.total, whole.moment.sum(axis=0), whole.count * whole.noise)[0]

        def lstsq() -> np.ndarray:
            return np.linalg.lstsq(laid.columns, laid.effort, rcond=None)[0]  # noqa: B023

        # they differ by the noise that the core takes out of the columns, which is little here
        np.testing.assert_allclose(core(), lstsq(), rtol=0.05)
        timed = in_turn({CORE: core, LSTSQ: lstsq}, rounds)
        shape = " x ".join(str(size) for size in laid.columns.shape)
        seconds = (f"{1e3 * timed.median(way):.3g} ms" for way in (LSTSQ, CORE))
        found.append((f"{duration:g} s, {shape}", *seconds, f"{timed.ratio(CORE, LSTSQ):.2f}"))
    says = (
        "The same columns, rows of the torque balance after the filter. The core sums normal equations over blocks of "
        "time, from which coefficients and a covariance for correlated residuals follow; `lstsq` gives coefficients."
    )
    return [Table(says, ("recording", LSTSQ, CORE, "ratio"), tuple(found))]
