"""Blocks that a script draws: they move, or zoom."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from bench.report.page.block import Block

#: How many times slower than it was a motion plays.
Slowed = Literal[1, 2, 5, 10, 20, 50, 100]


class Samples(Block):
    """A curve on the grid of its graph, in 16 bits; see `bench.report.page.samples`.

    Attributes:
        offset, scale: a value is offset + scale*number.
        low, high: numbers in base 64; `high` is None where one value stands for each interval.
    """

    offset: float
    scale: float
    low: str
    high: str | None


class Curve(Block):
    """A curve of a graph over time.

    Attributes:
        name: of it.
        role: how it is drawn: what was measured, what a model makes, or what a model leaves.
        choice: shown where this one of the graph's choices is made; None always.
        samples: of it.
    """

    name: str
    role: Literal["measured", "model", "left"]
    choice: int | None
    samples: Samples


class Panel(Block):
    """Curves over one y axis; `first`: whether those of the first choice stay in sight beside another one's."""

    label: str
    unit: str
    curves: tuple[Curve, ...]
    first: bool = False


class TimeGraph(Block):
    """Panels over one time axis that zoom, pan and hover together.

    Attributes:
        title: of the graph.
        alternative: what it shows, in words.
        start, step, count: of the grid of its curves - s.
        choices: models to choose from, the last one first in sight.
        panels: from top to bottom.
    """

    kind: Literal["time"] = "time"
    title: str
    alternative: str
    start: float
    step: float = Field(gt=0.0)
    count: int = Field(gt=0)
    choices: tuple[str, ...] = ()
    panels: tuple[Panel, ...]


class Motion(Block):
    """An axis in motion, with the one it is compared with as a ghost: a disk, or a slide on its rail.

    Attributes:
        title: of the drawing.
        alternative: what it shows, in words.
        turns: whether the axis does.
        unit: of its position.
        ghost: what the ghost is.
        start, step, count: of the instants - s.
        low, high: between which it is drawn, where it does not turn.
        slowed: how many times slower than the motion it plays at first.
        position, apart: of the ghost, and of the model less the ghost: 32-bit floats in base 64, nan where unknown.
    """

    kind: Literal["motion"] = "motion"
    title: str
    alternative: str
    turns: bool
    unit: str
    ghost: str
    start: float
    step: float = Field(gt=0.0)
    count: int = Field(gt=1)
    low: float
    high: float
    slowed: Slowed = 1
    position: str
    apart: str
