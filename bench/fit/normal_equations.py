"""Normal equations gathered block by block in time: one pass over a recording of any length."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, symmetric_inverse
from bench.axis_kind import COULOMB, INERTIA, VISCOUS

#: Blocks of time in filter widths: neighbouring blocks then share little beside the residual's own correlation.
BLOCK_WIDTHS = 8.0
#: Blocks that a covariance needs at most, of a recording and of each of its parts.
BLOCKS = 512
#: Power of a combination of scaled columns below which it is none but rounding.
ROUNDING = 1e-13
#: Share of the largest eigenvalue below which columns that are held against another one count as dependent.
DEPENDENT = 1e-9
#: Name of a column: a term of the equation of motion, what a recording has beside, or the index of an effect's term.
Name = str | int
#: Rows a block up to which a product for each costs more than sums over all of them; at 50 both cost the same.
SHORT = 24


@dataclass(frozen=True)
class NormalEquations:
    """Sums over blocks of time, from which estimate, residual and a covariance for correlated residuals follow.

    Attributes:
        names: of the columns (p,).
        gram: X'X of each block - (b, p, p).
        moment: X'y of each block - (b, p).
        power: y'y of each block - (b,).
        rows: of each block - (b,).
        noise: (p, p) covariance of the noise of the columns in a row.
    """

    names: tuple[Name, ...]
    gram: Array
    moment: Array
    power: Array
    rows: NDArray[np.int64]
    noise: Array

    def place(self, name: Name) -> int:
        """Where the one column of a name stands."""
        return self.names.index(name)

    def only(self, kept: Callable[[Name], bool]) -> NormalEquations:
        """The same equations for columns of some names only."""
        at = [place for place, name in enumerate(self.names) if kept(name)]
        gram, names = self.gram[:, at][:, :, at], tuple(self.names[place] for place in at)
        return replace(self, names=names, gram=gram, moment=self.moment[:, at], noise=self.noise[np.ix_(at, at)])

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
    def total(self) -> Array:
        """X'X of all rows - (p, p)."""
        return self.gram.sum(axis=0)

    @cached_property
    def matrix(self) -> Array:
        """X'X less what sensor noise put into it - (p, p)."""
        return self.total - self.count * self.noise

    @cached_property
    def _scaled(self) -> Array:
        """The matrix (p, p) in units in which every column has the power one."""
        power = np.diag(self.total)
        scale = np.sqrt(np.where(power > 0.0, power, 1.0))
        return self.matrix / np.outer(scale, scale)

    def solve(self, bounds: Mapping[Name, tuple[float, float]] | None = None) -> tuple[Array, Array]:
        """Coefficients (p,) within bounds by their names, and the inverse of the matrix (p, p)."""
        limits = {self.place(name): ends for name, ends in (bounds or {}).items()}
        theta, inverse, _ = bounded(self.total, self.moment.sum(axis=0), self.count * self.noise, limits)
        return theta, inverse

    def independent_shares(self, names: Sequence[Name]) -> Array:
        """Share of the power of each of some columns that is neither noise nor explained by the others (k,).

        Negative where it is noise alone.
        """
        places, at = [self.place(name) for name in names], np.arange(len(names))
        others = np.argsort(np.eye(len(names), dtype=bool), axis=1, kind="stable")[:, :-1]
        matrix = self._scaled[np.ix_(places, places)]
        beside, between = matrix[others, at[:, None]], matrix[others[:, :, None], others[:, None, :]]
        return np.diag(matrix) - np.einsum("ki,kij,kj->k", beside, symmetric_inverse(between, DEPENDENT), beside)

    @cached_property
    def shares_of_axis(self) -> dict[str, float]:
        """Independent shares of J, K_w and K_0 by their terms."""
        terms = INERTIA, VISCOUS, COULOMB
        return dict(zip(terms, self.independent_shares(terms).tolist(), strict=True))

    def knowing(self, name: Name, value: float, weight: float) -> NormalEquations:
        """The same equations and, as if it had been measured, about which value one coefficient has beforehand.

        Its weight is the variance of a row over that of the value.
        """
        gram, moment = np.zeros((1, *self.noise.shape)), np.zeros((1, self.noise.shape[0]))
        place = self.place(name)
        gram[0, place, place], moment[0, place] = weight, weight * value
        added = {"gram": np.concatenate([self.gram, gram]), "moment": np.concatenate([self.moment, moment])}
        none = np.zeros(1)
        return replace(self, power=np.append(self.power, none), rows=np.append(self.rows, none.astype(int)), **added)

    def scores(self, theta: Array) -> Array:
        """X'(y - X*theta) of each block, less the part of it that is due to noise in the columns - (b, p)."""
        return self.moment - self.gram @ theta + np.outer(self.rows, self.noise @ theta)

    def residual_power(self, theta: Array) -> float:
        """Sum of squared residuals of all rows - the effort's unit squared."""
        moment = self.moment.sum(axis=0)
        return float(self.power.sum() - 2.0 * theta @ moment + theta @ self.total @ theta)


def solved(gram: Array, moment: Array, noise: Array) -> tuple[Array, Array]:
    """Coefficients (p,) of X'X (p, p) and X'y (p,), and the inverse of the matrix that they came from.

    Noise in a column inflates its own square and draws its coefficient towards zero; taking the known power `noise`
    (p, p) out makes least squares consistent (Soderstrom, Errors-in-variables methods in system identification,
    Automatica 43(6), 2007, eq. 40).
    """
    scale = np.sqrt(np.diag(gram))
    scale = np.where(scale > 0.0, scale, 1.0)
    scales = np.outer(scale, scale)
    inverse = symmetric_inverse((gram - noise) / scales, ROUNDING) / scales
    return inverse @ moment, inverse


def bounded(
    gram: Array, moment: Array, noise: Array, bounds: Mapping[int, tuple[float, float]]
) -> tuple[Array, Array, tuple[int, ...]]:
    """Coefficients (p,) as of `solved`, each held at its bound where it would lie beyond, one after the other.

    Bounds are by places; beside it the inverse of the matrix with all free (p, p), and the places of those held.
    """
    theta, inverse = solved(gram, moment, noise)
    held: list[int] = []
    for place, (low, high) in bounds.items():
        if low <= theta[place] <= high:
            continue
        held.append(place)
        theta[place] = np.clip(theta[place], low, high)
        free = [k for k in range(theta.size) if k not in held]
        rest = moment[free] - gram[np.ix_(free, held)] @ theta[held]
        theta[free] = solved(gram[np.ix_(free, free)], rest, noise[np.ix_(free, free)])[0]
    return theta, inverse, tuple(held)


def normal_equations(
    names: Iterable[Name], columns: Array, effort: Array, time: Array, noise: Array, width: float
) -> NormalEquations:
    """Columns (m, p) of some names and effort (m,) gathered into blocks of time - s (m,); none without rows."""
    edges = block_edges(time, width)
    products = _products(columns, effort, edges)
    return NormalEquations(
        names=tuple(names),
        gram=products[:, :-1, :-1],
        moment=products[:, :-1, -1],
        power=products[:, -1, -1],
        rows=np.diff(edges),
        noise=noise,
    )


def _products(columns: Array, effort: Array, edges: NDArray[np.int64]) -> Array:
    """[X y]'[X y] of each block of rows between edges (b + 1,) - (b, p + 1, p + 1); columns X (m, p), effort y (m,).

    Of long blocks one by one; of short ones column by column over all blocks at once, which on 3 s at 1 kHz takes a
    fifth of the time.
    """
    count, width = max(edges.size - 1, 0), columns.shape[1] + 1
    if effort.size > SHORT * count:
        products = np.empty((count, width, width))
        table = np.column_stack([columns, effort])
        for index, (start, stop) in enumerate(pairwise(edges.tolist())):
            rows = table[start:stop]
            np.matmul(rows.T, rows, out=products[index])
        return products
    table, sums = np.vstack([columns.T, effort]), np.empty((width, width, count))
    for k in range(width if count else 0):
        sums[k, : k + 1] = sums[: k + 1, k] = np.add.reduceat(table[: k + 1] * table[k], edges[:-1], axis=1)
    return sums.transpose(2, 0, 1)


def block_edges(time: Array, width: float) -> NDArray[np.int64]:
    """First rows of blocks of BLOCK_WIDTHS filter widths - s -, of at most BLOCKS longer ones, and the end."""
    if not time.size:
        return np.empty(0, dtype=np.int64)
    count = int(np.clip((time[-1] - time[0]) / (BLOCK_WIDTHS * width), 1, BLOCKS))
    borders = np.linspace(time[0], time[-1], count + 1)[1:-1]
    return np.unique(np.concatenate([[0], np.searchsorted(time, borders), [time.size]]))


def join(parts: Sequence[NormalEquations]) -> NormalEquations:
    """Normal equations of a recording from those of its stretches, in order; all of the same columns."""
    if len(parts) == 1:
        return parts[0]
    sums = {
        name: np.concatenate([getattr(part, name) for part in parts]) for name in ("gram", "moment", "power", "rows")
    }
    return replace(parts[0], **sums)
