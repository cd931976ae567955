"""Search of a dead zone's shape in a recording, and how far that is determined.

Impacts are short and hard, and the instant of one depends on how the load left the other side of the gap: a few rows
have large residuals whatever the shape. So shapes are compared by Cauchy's likelihood, sum(log(1 + (r/s)**2)), which
tolerates them. A softer contact looks like a wider gap, and each impact errs by its own instant: a ridge along which
the likelihood is rough, so that its curvature at the top does not give the covariance of the shape. How the likeliest
shape moves does, when stretches of the recording are resampled with replacement (block bootstrap).
Source: P. J. Huber, E. M. Ronchetti, Robust Statistics, 2nd ed., 2009, ch. 7; B. Efron, R. J. Tibshirani, An
Introduction to the Bootstrap, 1993, sec. 8.6.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array, column_rms
from bench.effects.dead_zone import dead_zone_columns
from bench.effects.effect import Fitted
from bench.effects.shape import FREQUENCY, extended
from bench.effects.signals import Scope

#: Factors of gap, frequency and damping within which a recording does not distinguish two contacts.
INDISTINCT = (1.01, 1.1, 1.1)
#: Gaps in travel at the RMS speed over one filter width, wide ones closer; contacts - rad/s; damping ratio.
GAPS = (*np.geomspace(0.005, 0.8, 24).tolist(), *np.geomspace(0.88, 8.0, 24).tolist())
CONTACTS = tuple(2.0 * np.pi * f for f in (40.0, 80.0, 130.0, 210.0))
DAMPING = 0.4
#: Every so many gaps are tried first; the best takes at most so many times their squares: 1.9 times in 19 searches.
EVERY, BETTER = 4, 2.5
#: Offsets around a shape in each round of refinement - gap, frequency, damping -, and their first size, as e**offset.
OFFSETS = np.stack([m.ravel() for m in np.meshgrid(np.linspace(-1, 1, 5), [-1, 0, 1], [-1, 0, 1], indexing="ij")], 1)
SPREAD = (0.12, 0.4, 0.5)
ROUNDS, STARTS, ALL_STARTS = 6, 3, 2
#: Residual in noise floors beyond which a row counts less and less, and reweightings of the least squares.
SCALE, REWEIGHTED = 3.0, 6
#: Added to the squares of each column, as share of them: columns that are alike share what they explain.
RIDGE = 1e-12
#: Samples of all shapes tried at once, which bounds memory: 8 bytes each, some four times over.
TOGETHER = 4_000_000
#: Factors e**x around a shape that are compared for its spread: of gap, frequency and damping.
AROUND = (np.linspace(-0.12, 0.12, 7), np.linspace(-0.6, 0.6, 5), np.linspace(-0.5, 0.5, 3))
#: Length of what is drawn: longer than a load rings after an impact - s.
STRETCH = 0.2
#: Standard errors that all resampled recordings share, as shares: rebounds run faster than samples follow. On 39 drawn
#: axes logarithms err by .03, .50, 1.46 (`python -m tests.studies.blind --only backlash`, seeds 101 and 102).
SHARED = np.array([0.02, 0.45, 1.4])
#: Resampled recordings.
DRAWS = 400


@dataclass(frozen=True)
class Likely:
    """A dead zone's shape (4,), its negative logarithm of likelihood, and the load's spring rate that comes of it."""

    shape: Array
    misfit: float
    spring_rate: float

    def around(self, factors: Array) -> Array:
        """Shapes (k, 4) around it, with the spring that was found with it."""
        return np.column_stack([self.shape[:3] * factors, np.full(len(factors), self.spring_rate)])


def likeliest_shape(fitted: Fitted, promises: Callable[[float], bool]) -> tuple[float, ...] | None:
    """Gap, contact's frequency and damping ratio, and spring's rate, added to a fit without them; see `load_positions`.

    None where no shape of the first grid takes squares that promise more.
    """
    robust = Robust(fitted.columns, fitted.effort, SCALE * fitted.floor)

    def likeliest(shapes: Array, columns: Array) -> Likely:
        found = []
        for shape, (theta, unlikely) in zip(shapes, robust.with_each(columns), strict=True):
            rate, stiffness = float(shape[3]), _stiffness(fitted, theta[:-1])
            if rate > 0.0 and theta[-1] > 0.0 and stiffness > 0.0:
                rate = stiffness / float(theta[-1])
            found.append(Likely(shape, float(unlikely.sum()), rate))
        return min(found, key=lambda likely: likely.misfit)

    travel = fitted.scope.rms_speed * fitted.scope.width
    contacts = contacts_of(fitted.scope)
    load = fitted.base.inertia - fitted.scope.rotor_inertia
    pulled = max(_stiffness(fitted, fitted.theta), 0.0) / load if load > 0.0 else 0.0  # by a spring on the load's side
    springs = np.unique([0.0, pulled])
    grid = np.stack(np.meshgrid(contacts, np.array(GAPS) * travel, [DAMPING], springs, indexing="ij"), axis=-1)
    grid = grid[..., [1, 0, 2, 3]]  # each contact in steps of its own, of which a soft one needs few
    shapes, sampled = grid.reshape(len(contacts), -1, 4), np.zeros((len(GAPS), springs.size), dtype=bool)
    sampled[EVERY // 2 :: EVERY] = True
    few, others = sampled.ravel(), ~sampled.ravel()
    columns = [_columns(fitted, part[few]) for part in shapes]
    if not promises(BETTER * max(float(fitted.gains(table, 1).max()) for table in columns)):
        return None
    columns = [np.hstack([table, _columns(fitted, part[others])]) for part, table in zip(shapes, columns, strict=True)]
    if not promises(float(fitted.gains(np.concatenate(columns, axis=1), 1).max())):
        return None
    shapes = np.concatenate([shapes[:, few], shapes[:, others]], axis=1)
    starts = sorted(map(likeliest, shapes, columns), key=lambda likely: likely.misfit)[:STARTS]
    for level in range(1, ROUNDS):
        offsets = np.exp(OFFSETS * np.array(SPREAD) * 0.6 ** (level - 1))
        around = np.concatenate([start.around(offsets) for start in starts])
        columns = np.split(_columns(fitted, around), len(starts), axis=1)
        refined = map(likeliest, np.split(around, len(starts)), columns)
        starts = [min(pair, key=lambda likely: likely.misfit) for pair in zip(starts, refined, strict=True)]
        starts = sorted(starts, key=lambda likely: likely.misfit)[: STARTS if level < ALL_STARTS else 1]
    return tuple(float(value) for value in starts[0].shape)


def _columns(fitted: Fitted, shapes: Array) -> Array:
    """Columns (m, k) of many shapes, few at a time where the recording is long."""
    few = max(1, TOGETHER // max(fitted.time.size, 1))
    parts = [shapes[k : k + few] for k in range(0, len(shapes), few)]
    return np.concatenate([fitted.behind(dead_zone_columns, part.tolist()) for part in parts], axis=1)


def contacts_of(scope: Scope) -> list[float]:
    """Frequencies of contact that a search begins with - rad/s: one that swings faster than samples follow is rigid."""
    fastest = np.pi / scope.sample_period
    return sorted({min(contact, fastest) for contact in extended(CONTACTS, FREQUENCY.factor(scope))})


def _stiffness(fitted: Fitted, theta: Array) -> float:
    return float(theta[fitted.places(lambda effect: effect.spring)][:1].sum())


class Robust:
    """Fits of fixed columns (m, p) and one more to an effort (m,) by reweighted least squares.

    Products of the fixed columns are made once: a fit weighs them all by one product of matrices.
    """

    def __init__(self, fixed: Array, effort: Array, scale: float) -> None:
        self.scale, self.size = scale, column_rms(fixed) + 1e-300
        self.known = np.column_stack([fixed / self.size, effort]).T.copy()
        first, second = np.triu_indices(len(self.known))
        self.products = self.known[first] * self.known[second]
        self.place = np.empty((len(self.known),) * 2, dtype=np.intp)
        self.place[first, second] = self.place[second, first] = np.arange(first.size)

    def with_each(self, columns: Array) -> Iterator[tuple[Array, Array]]:
        """For each of the columns (m, k) coefficients (p + 1,), and each row's -log of Cauchy's likelihood (m,)."""
        few = max(1, TOGETHER // len(columns))
        for begin in range(0, columns.shape[1], few):
            yield from zip(*self._together(columns[:, begin : begin + few].T), strict=True)

    def _together(self, columns: Array) -> tuple[Array, Array]:
        """Coefficients (k, p + 1) and unlikelihoods (k, m) with each column (k, m)."""
        size, fixed, effort = np.sqrt(np.mean(columns**2, axis=1)) + 1e-300, self.known[:-1], self.known[-1]
        columns = columns / size[:, None]
        weight, theta, away = np.ones_like(columns), np.empty(0), np.empty(0)
        gram = np.empty((len(columns), len(self.known), len(self.known)))
        ridge = RIDGE * effort.size * np.eye(len(self.known))
        for _ in range(REWEIGHTED):
            weighted = weight * columns
            among, across = (weight @ self.products.T)[:, self.place], weighted @ self.known.T
            gram[:, :-1, :-1], gram[:, -1, -1] = among[:, :-1, :-1], np.einsum("km,km->k", weighted, columns)
            gram[:, -1, :-1] = gram[:, :-1, -1] = across[:, :-1]
            moment = np.column_stack([among[:, :-1, -1], across[:, -1]])
            theta = np.linalg.solve(gram + ridge, moment[..., None])[..., 0]
            away = ((effort - theta[:, :-1] @ fixed - theta[:, -1:] * columns) / self.scale) ** 2
            weight = 1.0 / (1.0 + away)
        return np.column_stack([theta[:, :-1] / self.size, theta[:, -1] / size]), np.log1p(away)


def open_torque(fitted: Fitted, shape: Sequence[float]) -> Array:
    """By how much the torque of a contact is undetermined in each row - N*m (N) per unit of load inertia - (m,).

    Rows soon after an impact are: its instant depends on how the load left the other side of the gap.
    """
    shapes = np.tile(shape, (2 * len(INDISTINCT) + 1, 1))
    for k, factor in enumerate(INDISTINCT):
        shapes[2 * k + 1, k] *= factor
        shapes[2 * k + 2, k] /= factor
    columns = fitted.behind(dead_zone_columns, shapes.tolist())
    return np.abs(columns[:, 1:] - columns[:, :1]).max(axis=1)


def spread(fitted: Fitted, shape: Sequence[float], place: int) -> Array:
    """Covariance of gap, frequency and damping (3, 3) of the contact whose column has a place, by resampled recordings.

    Along the ridge of softer contacts and wider gaps curvature does not give it.
    """
    contact, spring_rate = np.array(shape[:3]), shape[3]
    offsets = np.stack([m.ravel() for m in np.meshgrid(*AROUND, indexing="ij")], axis=1)
    shapes = np.column_stack([contact * np.exp(offsets), np.full(len(offsets), spring_rate)])
    others, time = np.delete(fitted.columns, place, axis=1), fitted.time
    edges = np.unique(np.searchsorted(time, np.arange(time[0], time[-1], STRETCH)))
    robust = Robust(others, fitted.effort, SCALE * fitted.floor)
    misfits = [np.add.reduceat(unlikely, edges) for _, unlikely in robust.with_each(_columns(fitted, shapes))]
    rng = np.random.default_rng(0)
    drawn = rng.multinomial(edges.size, np.full(edges.size, 1.0 / edges.size), size=DRAWS)
    likeliest = offsets[np.argmin(np.stack(misfits) @ drawn.T, axis=0)]
    step = np.array([axis[1] - axis[0] for axis in AROUND])
    relative = likeliest.T @ likeliest / DRAWS + np.diag(step**2 / 12.0 + SHARED**2)
    return relative * np.outer(contact, contact)
