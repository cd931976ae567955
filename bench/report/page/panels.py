"""The gap over coordinates as SVG: geometry only; the page's style sheet draws it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import MaxNLocator

from bench.report.page.blocks import GapGraph, Over

#: Size of a panel, and of its margins left, right, top, bottom - units of the drawing.
WIDTH, HEIGHT = 380.0, 230.0
LEFT, RIGHT, TOP, BOTTOM = 58.0, 12.0, 12.0, 42.0


@dataclass(frozen=True)
class Tick:
    """A place on an axis and its label."""

    at: float
    label: str


@dataclass(frozen=True)
class Drawn:
    """A panel in the drawing's units.

    Attributes:
        over: what it shows.
        x, y: ticks.
        floor: top and height of the band of noise.
        zero: of the gap.
        before, after: dots.
        explained: points of the line of what the effects account for; empty without one.
    """

    over: Over
    x: tuple[Tick, ...]
    y: tuple[Tick, ...]
    floor: tuple[float, float]
    zero: float
    before: tuple[tuple[float, float], ...]
    after: tuple[tuple[float, float], ...]
    explained: str


def drawn(graph: GapGraph) -> list[Drawn]:
    """All panels, on one scale."""
    values = [graph.floor, -graph.floor]
    for over in graph.panels:
        values += [*over.before, *(over.after or ())]
    top = 1.08 * max(map(abs, values), default=1.0) or 1.0
    return [_panel(graph, over, top) for over in graph.panels]


def _panel(graph: GapGraph, over: Over, top: float) -> Drawn:
    low, high = (min(over.x), max(over.x)) if over.x else (0.0, 1.0)
    margin = 0.03 * (high - low) or 0.5
    low, high = low - margin, high + margin

    def across(value: float) -> float:
        return round(LEFT + (value - low) / (high - low) * (WIDTH - LEFT - RIGHT), 1)

    def down(value: float) -> float:
        return round(TOP + (top - value) / (2.0 * top) * (HEIGHT - TOP - BOTTOM), 1)

    order = np.argsort(over.x)
    explained = ""
    if over.after is not None:
        points = [(across(over.x[k]), down(over.before[k] - over.after[k])) for k in order]
        explained = " ".join(f"{x},{y}" for x, y in points)
    return Drawn(
        over,
        tuple(Tick(across(value), label) for value, label in ticks(low, high, 5)),
        tuple(Tick(down(value), label) for value, label in ticks(-top, top, 5)),
        (down(graph.floor), round(down(-graph.floor) - down(graph.floor), 1)),
        down(0.0),
        tuple((across(x), down(y)) for x, y in zip(over.x, over.before, strict=True)),
        tuple((across(x), down(y)) for x, y in zip(over.x, over.after or (), strict=False)),
        explained,
    )


def ticks(low: float, high: float, most: int) -> Sequence[tuple[float, str]]:
    """Round values within bounds, with labels of as many digits as tell them apart."""
    places = [float(value) for value in MaxNLocator(most).tick_values(low, high) if low <= value <= high]
    step = min(np.diff(places), default=1.0)
    size = max(map(abs, places), default=1.0)
    if size >= 1e5 or size < 1e-3:
        return [(value, f"{value:.3g}") for value in places]
    decimals = next(n for n in range(9) if abs(round(step, n) - step) < 1e-6 * step)
    return [(value, f"{value + 0.0:.{decimals}f}".replace("-", "−")) for value in places]
