"""Intervals below each other as SVG: geometry only; the page's style sheet draws it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.report.page.blocks import Intervals, Span
from bench.report.page.chart import Scale, Tick, ticks

#: Width of a row - units of the drawing, which the page stretches.
WIDTH = 1000.0


@dataclass(frozen=True)
class Row:
    """A row in the drawing's units; `beyond`: whether its value lies outside of the scale."""

    span: Span
    at: float
    low: float
    high: float
    beyond: bool


@dataclass(frozen=True)
class Laid:
    """All rows on their scale; `right`: the band behind them."""

    rows: tuple[Row, ...]
    right: tuple[float, float]
    ticks: tuple[Tick, ...]


def laid(block: Intervals) -> Laid:
    """The rows, cut at the limits of the scale."""
    low, high = block.limits
    scale = Scale(low, high, 0.0, WIDTH)

    def place(value: float) -> float:
        return scale(float(np.clip(value, low, high)))

    rows = (
        Row(span, place(span.value), place(span.low), place(span.high), not low <= span.value <= high)
        for span in block.spans
    )
    marks = tuple(Tick(scale(value), label) for value, label in ticks(low, high, 5))
    return Laid(tuple(rows), (place(block.right[0]), place(block.right[1])), marks)
