"""What a task of the course returns: numbers with units, diagrams as data, and what they say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from bench.arrays import Array
from bench.errors import BenchError

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
    """

    name: str
    value: float
    unit: str
    truth: float | None = None
    source: str = RECORDING


@dataclass(frozen=True)
class Curve:
    """Points of a diagram, in the units of its panel's labels: x, y (n,); `wide` is to be drawn over."""

    x: Array
    y: Array
    label: str = ""
    style: Literal["line", "thin", "wide", "dashes", "dots", "bold dots", "reach"] = "line"


@dataclass(frozen=True)
class Panel:
    """One pair of axes, logarithmic where `log`; labels carry the unit, as `speed / (rad/s)`."""

    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    log: bool = False


@dataclass(frozen=True)
class Chart:
    """Panels one above the other; those with the same x label share their x axis."""

    title: str
    panels: tuple[Panel, ...]


def panel(x_label: str, y_label: str, *curves: Curve, log: bool = False) -> Panel:
    """Curves over one pair of axes, logarithmic where `log`; labels carry the unit, as `speed / (rad/s)`."""
    return Panel(x_label, y_label, curves, log)


def chart(title: str, *panels: Panel) -> Chart:
    """Panels one above the other; those with the same x label share their x axis."""
    return Chart(title, panels)


@dataclass(frozen=True)
class DoneTask:
    """A task that was done.

    Attributes:
        key: number in the course, or a name for what stands around the tasks.
        title: of the task.
        findings: a paragraph each.
        numbers: results.
        charts: diagrams.
        example: whether it is about the embedded example, whatever was recorded.
    """

    key: str
    title: str
    findings: tuple[str, ...] = ()
    numbers: tuple[Number, ...] = ()
    charts: tuple[Chart, ...] = ()
    example: bool = False

    def __getitem__(self, name: str) -> Number:
        return next(number for number in self.numbers if number.name == name)


@dataclass(frozen=True)
class NotDone:
    """A task that could not be done: its number, title, and what is missing."""

    key: str
    title: str
    reason: BenchError
