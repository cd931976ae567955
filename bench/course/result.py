"""What a task of the course comes to: numbers with units, diagrams as data, and what they say."""

from __future__ import annotations

from dataclasses import dataclass

from bench.arrays import Array
from bench.errors import BenchError
from bench.report.document import COLOURS, Chart, Panel, Series, Style, Table, series

#: Where a number comes from.
RECORDING, COMPUTED, SIMULATED, EXAMPLE = "recording", "computed", "simulated", "embedded example"


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
class TaskResult:
    """What a task comes to; what it leaves out of what follows `charts`, the course fills in.

    Attributes:
        findings: a paragraph each.
        numbers, charts: results and diagrams.
        key: number of the task in the course, or a name for what stands around the tasks.
        title: of the task.
        example: whether it is about the embedded example, whatever was recorded.
        reason: why it could not be done; None where it was.
        tables: beside that of the numbers, and the numbers that stand in them.
        equation: that the task solves.
    """

    findings: tuple[str, ...] = ()
    numbers: tuple[Number, ...] = ()
    charts: tuple[Chart, ...] = ()
    key: str = ""
    title: str = ""
    example: bool = False
    reason: BenchError | None = None
    tables: tuple[Table, ...] = ()
    tabled: tuple[Number, ...] = ()
    equation: str = ""

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
