"""A chart as SVG: geometry only; the page's style sheet draws it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import MaxNLocator

from bench.report.page.blocks import Axes, Chart, Series

#: Size of a panel, and of its margins left, right, top, bottom - units of the drawing; one panel alone is wider.
WIDTH, ALONE, HEIGHT = 380.0, 760.0, 230.0
LEFT, RIGHT, TOP, BOTTOM = 58.0, 12.0, 12.0, 42.0
#: Share of the span that is left free around the points.
MARGIN = 0.04


@dataclass(frozen=True)
class Tick:
    """A place on an axis and its label."""

    at: float
    label: str


@dataclass(frozen=True)
class Mark:
    """A series in the drawing's units: dots, the points of a line or of an area, and bars from dots to their bounds."""

    series: Series
    dots: tuple[tuple[float, float], ...]
    points: str
    bars: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class Panel:
    """A panel in the drawing's units; `zero` is None where the scale does not hold it."""

    axes: Axes
    width: float
    x: tuple[Tick, ...]
    y: tuple[Tick, ...]
    zero: float | None
    marks: tuple[Mark, ...]


@dataclass(frozen=True)
class Scale:
    """From values to the drawing: `low` at one end, `high` at the other."""

    low: float
    high: float
    start: float
    stop: float

    def __call__(self, value: float) -> float:
        """Where a value stands."""
        return round(self.start + (value - self.low) / (self.high - self.low) * (self.stop - self.start), 1)

    @classmethod
    def around(cls, values: Sequence[float], start: float, stop: float) -> Scale:
        """A scale that holds all values with a margin."""
        known = [value for value in values if np.isfinite(value)] or [0.0]
        low, high = min(known), max(known)
        margin = MARGIN * (high - low) or 0.5 * abs(high) or 0.5
        return cls(low - margin, high + margin, start, stop)


def drawn(chart: Chart) -> list[Panel]:
    """All panels, on one scale."""
    every = [series for axes in chart.panels for series in axes.series]
    heights = [value for series in every for value in (*series.y, *series.low, *series.high)]
    down = Scale.around(heights, HEIGHT - BOTTOM, TOP)
    width = ALONE if len(chart.panels) == 1 else WIDTH
    return [_panel(axes, down, width) for axes in chart.panels]


def _panel(axes: Axes, down: Scale, width: float) -> Panel:
    across = Scale.around([value for series in axes.series for value in series.x], LEFT, width - RIGHT)
    return Panel(
        axes,
        width,
        tuple(Tick(across(value), label) for value, label in ticks(across.low, across.high, 5)),
        tuple(Tick(down(value), label) for value, label in ticks(down.low, down.high, 5)),
        down(0.0) if down.low < 0.0 < down.high else None,
        tuple(_mark(series, across, down) for series in axes.series),
    )


def _mark(series: Series, across: Scale, down: Scale) -> Mark:
    x = [across(value) for value in series.x]
    dots = tuple(zip(x, map(down, series.y), strict=False))
    low, high = list(map(down, series.low)), list(map(down, series.high))
    around = dots if series.style == "line" else (*zip(x, low, strict=False), *zip(x[::-1], high[::-1], strict=False))
    bars = tuple(zip(x, low, high, strict=True)) if series.style != "band" and low else ()
    points = " ".join(f"{a},{b}" for a, b in around) if series.style in ("line", "band") else ""
    return Mark(series, dots if series.style in ("dots", "rings") else (), points, bars)


def ticks(low: float, high: float, most: int) -> list[tuple[float, str]]:
    """Round values within bounds, with labels of as many digits as tell them apart."""
    places = [float(value) for value in MaxNLocator(most).tick_values(low, high) if low <= value <= high]
    step = min(np.diff(places), default=1.0)
    size = max(map(abs, places), default=1.0)
    if size >= 1e5 or size < 1e-3:
        return [(value, f"{value:.3g}".replace("-", "−")) for value in places]
    decimals = next((n for n in range(9) if abs(round(step, n) - step) < 1e-6 * step), 9)
    return [(value, f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")) for value in places]
