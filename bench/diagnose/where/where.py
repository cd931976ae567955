"""Where the gap sits: the share of its variance that each coordinate accounts for, without assuming any effect."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.signal

from bench.arrays import Array
from bench.axis_kind import AxisKind
from bench.balance.fit import Fit

#: Bins of a coordinate, and rows that a bin needs.
BINS, LEAST = 48, 12


@dataclass(frozen=True)
class Where:
    """One coordinate's account of the gap.

    Attributes:
        coordinate: position velocity acceleration current time direction frequency reversal.
        region: bounds of the bins that hold most of what it accounts for - unit.
        unit: of the region.
        share: of the gap's variance, 0 to 1.
        centres, means: bins and the gap's mean in each - unit, N*m (N) - for the plot.
    """

    coordinate: str
    region: tuple[float, float]
    unit: str
    share: float
    centres: Array
    means: Array


def where(fitted: Fit, kind: AxisKind, effort_unit: str) -> list[Where]:
    """Shares of every coordinate, largest first."""
    rows = fitted.rows
    time, position, sign = rows.time, rows.values(lambda s: s.position), rows.values(lambda s: s.sign)
    turned = np.concatenate([[0.0], np.where(np.diff(sign) != 0.0, time[1:], 0.0)])
    turn = np.mod(position, 2.0 * np.pi) if kind.turns else position
    coordinates = {
        "position": (turn, kind.length_unit),
        "velocity": (rows.values(lambda s: s.velocity), kind.speed_unit),
        "acceleration": (fitted.columns[:, 0], kind.acceleration_unit),
        "current": (fitted.effort, effort_unit),
        "time": (time, "s"),
        "direction": (sign, "dimensionless"),
        "reversal": (time - np.maximum.accumulate(turned), "s"),
    }
    found = [_account(name, values, fitted.residual, unit) for name, (values, unit) in coordinates.items()]
    found.append(_frequency(fitted))
    return sorted(found, key=lambda account: -account.share)


def _account(name: str, values: Array, gap: Array, unit: str) -> Where:
    """Share of variance between bins of equal count, or of one value each, less what chance puts between them."""
    gap = gap - gap.mean()
    distinct, index = np.unique(values, return_inverse=True)
    if distinct.size > BINS:
        edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, BINS + 1)))
        index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, edges.size - 2)
    count = np.bincount(index)
    means = np.bincount(index, gap, minlength=count.size) / np.maximum(count, 1)
    centres = np.bincount(index, values, minlength=count.size) / np.maximum(count, 1)
    kept = count >= LEAST
    between, total = float(np.sum(count[kept] * means[kept] ** 2)), float(np.sum(gap**2))
    used = int(kept.sum())
    chance = (used - 1) * total / max(gap.size, 1)
    share = float(np.clip((between - chance) / max(total - chance, 1e-300), 0.0, 1.0))
    order = np.argsort(-(count * means**2))
    weight = np.cumsum((count * means**2)[order])
    main = order[: int(np.searchsorted(weight, 0.5 * weight[-1])) + 1]
    region = (float(centres[main].min()), float(centres[main].max()))
    return Where(name, region, unit, share, centres[kept], means[kept])


def _frequency(fitted: Fit) -> Where:
    """Share of the gap in the strongest narrow band of frequency, above an even spread over the band."""
    smooth = fitted.rows.conditioning.filter
    rate = 1.0 / (smooth.sample_period * smooth.stride)
    length = min(1024, fitted.residual.size)
    frequency, power = scipy.signal.welch(fitted.residual, rate, nperseg=length)
    shape = np.exp(-((2.0 * np.pi * frequency * smooth.width) ** 2))
    best = int(np.argmax(power[1:])) + 1
    band = slice(max(best - 2, 1), best + 3)
    share = float(np.sum(power[band]) / np.sum(power) - np.sum(shape[band]) / np.sum(shape))
    region = (float(frequency[band][0]), float(frequency[band][-1]))
    return Where("frequency", region, "Hz", max(share, 0.0), frequency, np.sqrt(power))
