"""Where the gap is: the share of its variance that each coordinate explains, without assuming any effect."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, hann, spectra
from bench.axis_kind import INERTIA, AxisKind
from bench.fit.fit import Fit
from bench.fit.hypothesis import unfiltered
from bench.fit.rows import Rows

#: Number of bins of a coordinate, and rows that a bin contains: fewer bins of a short recording.
BINS, LEAST = 48, 12
#: Bins of equal width that are drawn where they show MOST of what effects explain, rows of one, and points of a curve.
DRAWN, FEWEST, FINER, MOST = 192, 4, 4, 0.5
#: Distance of rows in widths of the filter beyond which their noise is uncorrelated: the correlation is exp(-9).
CORRELATED = 6.0


@dataclass(frozen=True)
class Where:
    """Share of the gap that one coordinate explains.

    Attributes:
        coordinate: position velocity acceleration current time direction frequency reversal.
        region: bounds of the bins with most of it - unit.
        unit: of the region.
        share: of the gap's variance, 0 to 1.
        centres, means: bins of equal width and the gap's mean in each - unit, N*m (N) - for the plot; of the part that
            effects explain without what the filter takes from it.
        after: the same means with all effects, then with the tables of an unknown effect; () of a frequency.
        curve: what the effects together explain, in finer bins - unit, N*m (N) - (c,); None of a frequency.
        bins: which of the bins contains each row (m,), -1 of a row in none of them; None of a frequency.
    """

    coordinate: str
    region: tuple[float, float]
    unit: str
    share: float
    centres: Array
    means: Array
    after: tuple[Array, ...] = ()
    curve: tuple[Array, Array] | None = None
    bins: NDArray[np.int16] | None = None


#: A coordinate along the rows of a recording: its name, as `Where` has it, the values by which rows are sorted into
#: bins (m,), the unit of their labels, and the values that label them, where those are noisier (m,).
Coordinate = tuple[str, Array, str, Array]


def where(
    fitted: Fit,
    kind: AxisKind,
    effort_unit: str,
    current: Array | None = None,
    after: Sequence[Array] = (),
    sharp: Array | None = None,
) -> list[Where]:
    """Shares of every coordinate of the gap of a fit, its residual, largest first.

    Args:
        current: as reported at the rows - A - (m,); None where another effort is.
        after: residuals of later models, for `Where.after` - N*m (N) - (m,) each.
        sharp: what the filter takes from the torque of their effects - N*m (N) - (m,).
    """
    explained = None if not after else fitted.left - after[0] + (0.0 if sharp is None else sharp)
    found = [_account(one, fitted, after, explained) for one in coordinates(fitted, kind, effort_unit, current)]
    found.append(_frequency(fitted))
    return sorted(found, key=lambda account: -account.share)


def coordinates(fitted: Fit, kind: AxisKind, effort_unit: str, current: Array | None = None) -> list[Coordinate]:
    """What the gap may depend on, along the rows; arguments as `where` has them."""
    rows = fitted.rows
    time, position, sign = rows.time, rows.values(lambda s: s.position), rows.values(lambda s: s.sign)
    turned = np.concatenate([[0.0], np.where(np.diff(sign) != 0.0, time[1:], 0.0)])
    turn = np.mod(position, 2.0 * np.pi) if kind.turns else position
    modelled = fitted.effort - fitted.left  # the measured effort contains the gap: sorted by it, noise has a share
    unit, reported = (effort_unit, fitted.effort) if current is None else ("A", current)
    along = (
        ("position", turn, kind.length_unit),
        ("velocity", rows.values(lambda s: s.velocity), kind.speed_unit),
        ("acceleration", fitted.columns[:, fitted.owners == INERTIA][:, 0], kind.acceleration_unit),
        ("current", modelled, unit),
        ("time", time, "s"),
        ("direction", sign, "dimensionless"),
        ("reversal", time - np.maximum.accumulate(turned), "s"),
    )
    return [(name, values, unit, reported if name == "current" else values) for name, values, unit in along]


def bins_of(values: Array) -> NDArray[np.int64]:
    """Bin of each row (m,): of equal count, or of one value each where there are few."""
    most = int(np.clip(values.size // LEAST, 1, BINS))
    return _between(values, most, lambda: np.unique(np.quantile(values, np.linspace(0.0, 1.0, most + 1))))


def equal_bins_of(values: Array, most: int) -> NDArray[np.int64]:
    """Bin of each row (m,): so many of equal width, or of one value each where there are few."""
    return _between(values, most, lambda: np.linspace(values.min(), values.max(), most + 1))


def _between(values: Array, most: int, edges: Callable[[], Array]) -> NDArray[np.int64]:
    distinct, index = np.unique(values, return_inverse=True)
    if distinct.size > most:
        bounds = edges()
        index = np.clip(np.searchsorted(bounds, values, side="right") - 1, 0, bounds.size - 2)
    return np.asarray(index, dtype=np.int64)


def means_in(index: NDArray[np.int64], values: Array) -> Array:
    """Mean of values (m,) in each bin (b,)."""
    count = np.bincount(index)
    return np.bincount(index, values, minlength=count.size) / np.maximum(count, 1)


def by_chance(index: NDArray[np.int64], kept: NDArray[np.bool_], rows: Rows) -> float:
    """Share of the variance of filtered white noise that is expected between bins, 0 to 1.

    Rows at a distance tau in time correlate as rho = exp(-(tau/(2*width))**2), so that the means m_b of n_b rows have

        E[sum of n_b*(m_b - mean)**2] = variance*(sum over bins of (sum over i, j in b of rho)/n_b - share*K)

    with K the rows of one independent sample and `share` of the rows (m,) that are in bins (b,) which are kept. For
    independent rows it is the number of bins less one over that of rows.
    """
    time, width = rows.time, rows.conditioning.filter.width
    weight = np.where(kept, 1.0 / np.maximum(np.bincount(index), 1), 0.0)[index]
    own, whole = float(weight.sum()), 1.0
    for lag in range(1, time.size):
        distance = np.abs(time[lag:] - time[:-lag])
        if distance.min() > CORRELATED * width:
            break
        correlation = 2.0 * np.exp(-((distance / (2.0 * width)) ** 2))
        own += float(np.sum((correlation * weight[lag:])[index[lag:] == index[:-lag]]))
        whole += float(correlation.sum()) / time.size
    return max(own - whole * float(np.mean(kept[index])), 0.0) / max(time.size - whole, 1.0)


def filtered_away(fitted: Fit) -> Array:
    """What the filter takes from the torque of a fit's terms, where they have one without it - N*m (N) - (m,)."""
    taken = np.zeros(fitted.left.size)
    for index, torque in unfiltered(fitted.rows, fitted.hypothesis, fitted.found).items():
        own = fitted.owners == index
        taken += torque - fitted.columns[:, own] @ fitted.theta[own]
    return taken


def _account(coordinate: Coordinate, fitted: Fit, after: Sequence[Array], explained: Array | None = None) -> Where:
    """Share of variance between bins, less what chance puts between them."""
    name, values, unit, labels = coordinate
    gap = fitted.residual - fitted.residual.mean()
    index = bins_of(values)
    count, means, centres = np.bincount(index), means_in(index, gap), means_in(index, labels)
    kept = count >= LEAST
    between, total = float(np.sum(count[kept] * means[kept] ** 2)), float(np.sum(gap**2))
    chance = total * by_chance(index, kept, fitted.rows)
    share = float(np.clip((between - chance) / max(total - chance, 1e-300), 0.0, 1.0))
    order = np.argsort(-(count * means**2))
    weight = np.cumsum((count * means**2)[order])
    main = order[: int(np.searchsorted(weight, 0.5 * weight[-1])) + 1]
    region = (float(centres[main].min()), float(centres[main].max()))
    many, few = (equal_bins_of(values, max(1, min(most, values.size // LEAST))) for most in (DRAWN, BINS))
    fine = explained is not None and np.var(means_in(many, explained)[many]) > MOST * max(np.var(explained), 1e-300)
    index = many if fine else few
    kept = np.bincount(index) >= FEWEST
    gaps = [fitted.left if explained is None else explained + after[0], *after]
    centres, before, *later = (means_in(index, of)[kept] for of in (labels, *gaps))
    smooth = equal_bins_of(values, FINER * DRAWN) if fine else few
    curve = None if explained is None else _curve(smooth, labels, explained)
    bins = np.where(kept, np.cumsum(kept) - 1, -1)[index].astype(np.int16)
    return Where(name, region, unit, share, centres, before, tuple(later), curve, bins)


def _curve(index: NDArray[np.int64], labels: Array, explained: Array) -> tuple[Array, Array]:
    """What effects explain over a coordinate (c,), in bins of at least a row, as it has no noise."""
    filled = np.bincount(index) > 0
    at, torque = (means_in(index, of)[filled] for of in (labels, explained))
    order = np.argsort(at)
    return at[order], torque[order]


def _frequency(fitted: Fit) -> Where:
    """Share of the gap in the strongest narrow band of frequency, above an even spread over the band."""
    smooth = fitted.rows.conditioning.filter
    rate = 1.0 / (smooth.sample_period * smooth.stride)
    length = min(1024, fitted.residual.size)
    frequency, power = _welch(fitted.residual, rate, length)
    shape = np.exp(-((2.0 * np.pi * frequency * smooth.width) ** 2))
    best = int(np.argmax(power[1:])) + 1
    band = slice(max(best - 2, 1), best + 3)
    share = float(np.sum(power[band]) / np.sum(power) - np.sum(shape[band]) / np.sum(shape))
    region = (float(frequency[band][0]), float(frequency[band][-1]))
    return Where("frequency", region, "Hz", max(share, 0.0), frequency, np.sqrt(power))


def _welch(values: Array, rate: float, length: int) -> tuple[Array, Array]:
    """Frequencies - Hz - and power density there of values (m,) at a rate - their unit squared over Hz."""
    window = hann(length)
    density = np.mean(np.abs(spectra(values, window)) ** 2, axis=0) / (rate * np.sum(window**2))
    density[1 : (length + 1) // 2] *= 2.0
    return np.fft.rfftfreq(length, 1.0 / rate).astype(np.float64), density
