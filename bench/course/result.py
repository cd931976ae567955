"""The result of a task of the course: numbers with units, diagrams as data, and findings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.errors import BenchError
from bench.report.document import COLOURS, Chart, Panel, Series, Style, Table, series

#: Points that can be distinguished across a diagram.
COLUMNS = 400
#: Where a number comes from.
RECORDING, COMPUTED, SIMULATED = "recording", "computed", "simulated"


@dataclass(frozen=True)
class Number:
    """A result.

    Attributes:
        name: of the quantity.
        value: in `unit`.
        unit: as the course writes it.
        truth: the simulated axis' value in the same unit, where the recording is synthetic.
        source: where it comes from, e.g. `recording`, `rig file`, `datasheet`, `assumed`; several joined by commas.
        half: the value is known within so much, with 95 % - in `unit`; None where that is not estimated.
    """

    name: str
    value: float
    unit: str
    truth: float | None = None
    source: str = RECORDING
    half: float | None = None


@dataclass(frozen=True)
class Equation:
    """An equation as plain text, as mathematics of Typst, and its number in the course's text, where it has one."""

    text: str
    mathematics: str
    number: str = ""


@dataclass(frozen=True)
class TaskResult:
    """What a task comes to; what it leaves out of what follows `charts`, the course fills in.

    Attributes:
        findings: a paragraph each; the first answers the task.
        numbers, charts: results and diagrams.
        key: number of the task in the course, or a name for what surrounds the tasks.
        title: of the task.
        reason: why it could not be done; None where it was.
        tables: in addition to that of the numbers, and their numbers.
        equation: that the task solves.
    """

    findings: tuple[str, ...] = ()
    numbers: tuple[Number, ...] = ()
    charts: tuple[Chart, ...] = ()
    key: str = ""
    title: str = ""
    reason: BenchError | None = None
    tables: tuple[Table, ...] = ()
    tabled: tuple[Number, ...] = ()
    equation: Equation | None = None

    def __getitem__(self, name: str) -> Number:
        return next(number for number in (*self.numbers, *self.tabled) if number.name == name)


def curve(x: Array, y: Array, name: str = "", style: Style = "line") -> Series:
    """Points (n,) of a diagram, in the units of its panel's labels; `wide` is to be drawn over."""
    return series(name, style, "ink", x, y)


def panel(x_label: str, y_label: str, *curves: Series, log: bool = False, first: int = 0) -> Panel:
    """Curves one over the other, each in the next colour.

    Args:
        x_label, y_label: of the axes with their units, as `speed / (rad/s)`.
        curves: over these axes.
        log: whether both axes are logarithmic.
        first: number of the first one's colour, where the curves are others' continued.
    """
    coloured = (
        one.model_copy(update={"colour": COLOURS[place % len(COLOURS)]}) for place, one in enumerate(curves, first)
    )
    return Panel(x_label=x_label, y_label=y_label, series=tuple(coloured), log=log)


def chart(title: str, *panels: Panel) -> Chart:
    """Panels one above the other; those with the same x label share their x axis."""
    shown = "; ".join(f"{panel.y_label} over {panel.x_label}" for panel in panels)
    return Chart(title=title, alternative=f"{shown}.", panels=panels)


def thinned(whole: Chart) -> Chart:
    """A chart of the points that a page can show: of a line, the extremes of each of COLUMNS stretches.

    Of dots those stay that have a place of their own, a COLUMNS-th of the width and a third of that number high.
    """
    panels = []
    for one in whole.panels:
        x = np.concatenate([np.asarray(each.x) for each in one.series] or [np.zeros(0)])
        y = np.concatenate([np.asarray(each.y) for each in one.series] or [np.zeros(0)])
        if one.log or x.size <= COLUMNS:
            panels.append(one)
            continue
        spans = (float(np.ptp(x)) or 1.0) / COLUMNS, (float(np.ptp(y)) or 1.0) / COLUMNS * 3.0
        thin = [_thinned(each, *spans) for each in one.series]
        panels.append(one.model_copy(update={"series": tuple(thin)}))
    return whole.model_copy(update={"panels": tuple(panels)})


def _thinned(one: Series, across: float, up: float) -> Series:
    x, y = np.asarray(one.x), np.asarray(one.y)
    if x.size <= 2 * COLUMNS and one.style != "dots":
        return one
    if one.style in ("dots", "large dots", "rings"):
        _, kept = np.unique(np.stack([np.round(x / across), np.round(y / up)]), axis=1, return_index=True)
    elif np.all(np.diff(x) >= 0.0):
        starts = np.flatnonzero(np.diff(np.floor((x - x[0]) / across), prepend=-1.0))
        parts = list(zip(starts, [*starts[1:], x.size], strict=True))
        kept = [start + place(y[start:stop]) for start, stop in parts for place in (np.argmin, np.argmax)]
    else:
        return one
    kept = np.unique(kept)
    return one.model_copy(update={"x": tuple(x[kept].tolist()), "y": tuple(y[kept].tolist())})
