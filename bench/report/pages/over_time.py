"""Speed and torque of a recording over time, measured beside each of several models."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.report.page.numbers import unit_text
from bench.report.page.samples import Grid
from bench.report.page.scripted import Curve, Panel, TimeGraph

Values = NDArray[np.floating]


@dataclass(frozen=True)
class Measured:
    """A signal and what each of several models leaves of it.

    Attributes:
        label, unit: of it.
        time: s - (n,).
        values: as measured (n,).
        left: measured less modelled, for each model (n,); None where it says nothing.
        modelled: what a model's signal is called.
        apart: whether what is left has a panel of its own, on its own scale.
        name: what the values are called.
    """

    label: str
    unit: str
    time: Array
    values: Values
    left: Sequence[Values | None] = ()
    modelled: str = "simulated"
    apart: bool = True
    name: str = "measured"

    @property
    def shown(self) -> list[tuple[int, Values]]:
        """Models that say something."""
        return [(k, left) for k, left in enumerate(self.left) if left is not None and np.isfinite(left).any()]

    @property
    def curves(self) -> int:
        """How many curves it takes."""
        return 1 + (2 if self.apart else 1) * len(self.shown)


def time_graph(
    title: str,
    alternative: str,
    time: Array,
    signals: Sequence[Measured],
    choices: Sequence[str] = (),
    part: float = 1.0,
) -> TimeGraph:
    """Signals over one time axis.

    Args:
        title, alternative: of the graph.
        time: of the recording - s - (n,).
        signals: from top to bottom.
        choices: names of the models.
        part: of what a page may hold that this graph may take.
    """
    grid = Grid.of(time, sum(signal.curves for signal in signals), part)
    panels: list[Panel] = []
    for signal in signals:
        panels += _panels(signal, grid, choices)
    found = {"start": grid.start, "step": grid.step, "count": grid.count}
    return TimeGraph(title=title, alternative=alternative, choices=tuple(choices), panels=tuple(panels), **found)


def _panels(signal: Measured, grid: Grid, choices: Sequence[str]) -> list[Panel]:
    places, unit = grid.places(signal.time), unit_text(signal.unit)
    curves = [Curve(name=signal.name, role="measured", choice=None, samples=grid.samples(places, signal.values))]
    rest = []
    for k, left in signal.shown:
        samples = grid.samples(places, signal.values - left)
        curves.append(Curve(name=signal.modelled, role="model", choice=k, samples=samples))
        if signal.apart:
            name = choices[k] if k < len(choices) else "left"
            rest.append(Curve(name=name, role="left", choice=k, samples=grid.samples(places, left)))
    found = [Panel(label=signal.label, unit=unit, curves=tuple(curves))]
    if rest:
        label = f"{signal.label}, {signal.name} less {signal.modelled}"
        found.append(Panel(label=label, unit=unit, curves=tuple(rest), first=True))
    return found
