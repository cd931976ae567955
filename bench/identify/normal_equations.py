"""Normal equations gathered block by block in time: one pass over a recording of any length."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.identify.regressors import Regressors


@dataclass(frozen=True)
class NormalEquations:
    """Sums over blocks of time, from which estimate, residual and a covariance for correlated residuals follow.

    Attributes:
        names: of the p columns.
        gram: X'X of each block - (b, p, p).
        moment: X'y of each block - (b, p).
        power: y'y of each block - (b,).
        rows: of each block - (b,).
        noise: (p,) standard deviation of the noise in each column.
    """

    names: tuple[str, ...]
    gram: NDArray[np.float64]
    moment: NDArray[np.float64]
    power: NDArray[np.float64]
    rows: NDArray[np.int64]
    noise: NDArray[np.float64]

    def select(self, names: Sequence[str]) -> NormalEquations:
        """The same equations for some of the columns only."""
        kept = [self.names.index(name) for name in names]
        gram = self.gram[:, kept][:, :, kept]
        return replace(self, names=tuple(names), gram=gram, moment=self.moment[:, kept], noise=self.noise[kept])

    def coarsened(self, limit: int) -> NormalEquations:
        """The same equations with neighbouring blocks joined until there are at most `limit`."""
        if self.rows.size <= limit:
            return self
        starts = np.arange(0, self.rows.size, -(-self.rows.size // limit))
        sums = {name: np.add.reduceat(getattr(self, name), starts) for name in ("gram", "moment", "power", "rows")}
        return replace(self, **sums)

    @cached_property
    def count(self) -> int:
        """Rows of all blocks."""
        return int(self.rows.sum())

    @cached_property
    def matrix(self) -> NDArray[np.float64]:
        """X'X less what sensor noise put onto its diagonal - (p, p).

        Noise in a column inflates its own square and draws its coefficient towards zero; taking the known variance out
        makes least squares consistent (Soderstrom, Errors-in-variables methods in system identification, Automatica
        43(6), 2007, eq. 40).
        """
        return self.gram.sum(axis=0) - np.diag(self.count * self.noise**2)

    def scores(self, estimate: NDArray[np.float64]) -> NDArray[np.float64]:
        """X'(y - X*theta) of each block, less the part of it that is due to noise in the columns - (b, p)."""
        noise = self.rows[:, None] * self.noise**2 * estimate
        return self.moment - self.gram @ estimate + noise

    def residual_power(self, estimate: NDArray[np.float64]) -> float:
        """Sum of squared residuals of all rows - the effort's unit squared."""
        gram, moment = self.gram.sum(axis=0), self.moment.sum(axis=0)
        return float(self.power.sum() - 2.0 * estimate @ moment + estimate @ gram @ estimate)


def normal_equations(regressors: Regressors, block: float, most: int) -> NormalEquations:
    """Gather rows into blocks of time; blocks without rows do not appear.

    Args:
        regressors: columns of one stretch.
        block: duration of a block - s; longer where there would be more than `most` of them.
        most: number of blocks.
    """
    table, time = regressors.table, regressors.time
    edges = np.empty(0, dtype=np.int64)
    if time.size:
        count = int(np.clip((time[-1] - time[0]) / block, 1, most))
        borders = np.linspace(time[0], time[-1], count + 1)[1:-1]
        edges = np.unique(np.concatenate([[0], np.searchsorted(time, borders), [time.size]]))
    products = np.zeros((max(edges.size - 1, 0), table.shape[1], table.shape[1]))
    for index, (start, stop) in enumerate(pairwise(edges.tolist())):
        rows = table[start:stop]
        np.matmul(rows.T, rows, out=products[index])
    return NormalEquations(
        names=regressors.names,
        gram=products[:, :-1, :-1],
        moment=products[:, :-1, -1],
        power=products[:, -1, -1],
        rows=np.diff(edges),
        noise=regressors.noise,
    )


def join(parts: Sequence[NormalEquations]) -> NormalEquations:
    """Normal equations of a recording from those of its stretches, in order; all of the same columns."""
    stacked = [np.concatenate([getattr(part, name) for part in parts]) for name in ("gram", "moment", "power", "rows")]
    return NormalEquations(parts[0].names, *stacked, noise=parts[0].noise)
