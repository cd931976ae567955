"""Coefficients of columns that belong to no equation of motion, by least squares with intervals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.arrays import Array
from bench.errors import UndeterminedError
from bench.fit.solution import INDEPENDENT_SHARE, block_edges, equations, estimated, misfit
from bench.parameter import Parameter
from bench.trace.filter import GaussianFilter
from bench.trace.trace import Trace

#: A constant whose interval is wider to one side than this share of it is not determined.
DETERMINED = 0.5
#: Rows for each coefficient, and what to record for them.
LEAST = 20
STEPS = "steps in both directions, from standstill to full speed"
ALIKE = "current and motion change in the same way"


def filtered(
    trace: Trace, smooth: GaussianFilter, signals: Sequence[Array], orders: Sequence[int]
) -> tuple[Array, Array]:
    """Times (m,) and filtered derivatives of these orders of signals (n,) each - (p, m)."""
    times, tables = [], []
    for part in trace.segments:
        if part.stop - part.start > 2 * smooth.margin:
            of = [[(values[part], order)] for values, order in zip(signals, orders, strict=True)]
            tables.append(smooth.columns(of))
            times.append(trace.time[part][smooth.margin : part.stop - part.start - smooth.margin : smooth.stride])
    return np.concatenate(times), np.concatenate(tables, axis=1)


def regressed(
    time: Array,
    table: Array,
    noise: Sequence[float] | Array,
    own: float,
    smooth: GaussianFilter,
    alike: str = ALIKE,
    record: str = STEPS,
) -> list[Parameter]:
    """Coefficients of columns, the last of a table (p + 1, m) by the others, with intervals, without unit.

    Args:
        time: of the rows (m,).
        noise: variance of the noise in each column (p,), or its covariance (p, p).
        own: of the raw signal that they explain.
        smooth: the filter of all.
        alike: what it means that the others explain the first or the second column.
        record: what to record then.

    Raises:
        UndeterminedError: they do, or there are too few rows.
    """
    names = tuple(range(len(table) - 1))
    noise = np.diag(noise) if np.ndim(noise) == 1 else np.asarray(noise)
    fitted = equations(names, table, noise, block_edges(time, smooth.width))
    if time.size < LEAST * len(names) or min(fitted.independent_shares(names)[:2]) < INDEPENDENT_SHARE:
        raise UndeterminedError("a coefficient", alike, record)
    theta, inverse = fitted.solved()
    covariance, reach = estimated(fitted.scores(theta), inverse, own**2 / smooth.stride)
    floor = float(np.sqrt((own * smooth.noise_gain(0)) ** 2 + theta @ noise @ theta))
    beyond = misfit(table[:-1].T, table[-1] - theta @ table[:-1], floor)
    errors = np.sqrt(np.diag(covariance))
    return [
        Parameter.around(value, "", error, reach * error).widened(wide)
        for value, error, wide in zip(theta.tolist(), errors.tolist(), beyond.tolist(), strict=True)
    ]
