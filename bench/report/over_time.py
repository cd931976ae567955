"""Signals over time as a document stores them: lowest and highest value of each interval, in 16 bits.

A page draws at most a few intervals per pixel, so what lies between lowest and highest of an interval would not show.
Signals of unlike rows (every sample, rows of a torque balance) come on one grid: one time axis for all. A document has
as many intervals as `Grid.of` gives it; a page that becomes too large has `coarser` ones.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.report.document import (
    ModelRun,
    Moving,
    Panel,
    Part,
    RobotDrawing,
    Samples,
    TimeCurve,
    TimeGraph,
    TimePanel,
    packed,
)
from bench.report.numbers import unit_text

Values = NDArray[np.floating]
AnyOf = TypeVar("AnyOf", bound=Part)

#: Numbers of a graph at most, and how many times that where each sample is one.
MOST, EXACT = 170_000, 1.5
#: Steps between lowest and highest value, and the code of no value.
STEPS, NOTHING = 65534, -32768
#: Bits of each value that longer intervals go without: 4096 steps remain, ten for each pixel.
ROUGH = 4


@dataclass(frozen=True)
class Grid:
    """Intervals of length `step` - s - from `start` - s - on; a `single` one has one value, a sample period."""

    start: float
    step: float
    count: int
    single: bool

    @classmethod
    def of(cls, time: Array, curves: int) -> Grid:
        """Grid for so many curves of a graph over time - s - (n,)."""
        most = MOST / curves
        period = float(np.median(np.diff(time[: min(time.size, 10_000)])))
        span = float(time[-1] - time[0])
        samples = round(span / period) + 1
        if samples <= EXACT * most:
            return cls(float(time[0]), period, samples, True)
        count = max(2, int(most / 2))
        return cls(float(time[0]), span / (count - 1), count, False)

    def places(self, time: Array) -> NDArray[np.int64]:
        """Interval of each time (n,)."""
        found = np.rint((time - self.start) / self.step).astype(np.int64)
        return np.clip(found, 0, self.count - 1)

    def samples(self, places: NDArray[np.int64], values: Values) -> Samples:
        """A curve on the grid: values (n,) at ascending places (n,); nan is a hole."""
        known = np.isfinite(values)
        places, values = (places, values) if known.all() else (places[known], values[known])
        low, high = np.full(self.count, np.nan), np.full(self.count, np.nan)
        if values.size:
            first = np.flatnonzero(np.diff(places, prepend=-1))
            low[places[first]] = np.minimum.reduceat(values, first)
            high[places[first]] = np.maximum.reduceat(values, first)
        return in_steps(0.5 * (low + high)) if self.single else in_steps(low, high)


def in_steps(low: Values, high: Values | None = None) -> Samples:
    """Values (n,), or lowest and highest ones, in 16 bits; nan is a hole."""
    both = low if high is None else np.concatenate([low, high])
    known = both[np.isfinite(both)]
    least, most = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    middle, scale = 0.5 * (least + most), (most - least) / STEPS or 1.0
    highest = None if high is None else _stepped(high, middle, scale)
    return Samples(offset=middle, scale=scale, low=_stepped(low, middle, scale), high=highest)


def _stepped(values: Values, middle: float, scale: float) -> str:
    """16-bit steps from the middle of the range, little endian, in base 64."""
    steps = np.clip(np.rint((values - middle) / scale), -STEPS // 2, STEPS // 2)
    return packed(np.where(np.isnan(steps), NOTHING, steps), "<i2")


def unpacked(samples: Samples) -> tuple[Array, Array]:
    """Lowest and highest value of each interval (count,), nan where there is none."""
    found = []
    for text in (samples.low, samples.high or samples.low):
        steps = np.frombuffer(base64.b64decode(text), dtype="<i2").astype(np.float64)
        found.append(np.where(steps == NOTHING, math.nan, samples.offset + samples.scale * steps))
    return found[0], found[1]


@dataclass(frozen=True)
class Plotted:
    """A signal and the residual of each of several models.

    Attributes:
        label, unit: of it.
        time: s - (n,).
        values: as measured (n,).
        left: measured less modelled, for each model (n,); None where it predicts nothing.
        modelled: what a model's signal is called.
        name: what the values are called.
    """

    label: str
    unit: str
    time: Array
    values: Values
    left: Sequence[Values | None] = ()
    modelled: str = "simulated"
    name: str = "measured"

    @property
    def shown(self) -> list[tuple[int, Values]]:
        """Models that predict something."""
        return [(k, left) for k, left in enumerate(self.left) if left is not None and np.isfinite(left).any()]


def time_graph(
    title: str,
    alternative: str,
    time: Array,
    signals: Sequence[Plotted],
    choices: Sequence[str] = (),
) -> TimeGraph:
    """Signals from top to bottom over the time of a recording - s - (n,).

    Args:
        choices: names of the models.
    """
    grid = Grid.of(time, sum(1 + 2 * len(signal.shown) for signal in signals))
    panels = []
    for signal in signals:
        places, unit, left = grid.places(signal.time), unit_text(signal.unit), []
        measured = grid.samples(places, signal.values)
        curves = [TimeCurve(name=signal.name, role="measured", choice=None, samples=measured)]
        for k, rest in signal.shown:
            samples = grid.samples(places, signal.values - rest)
            curves.append(TimeCurve(name=signal.modelled, role="model", choice=k, samples=samples))
            name = choices[k] if k < len(choices) else "residual"
            left.append(TimeCurve(name=name, role="residual", choice=k, samples=grid.samples(places, rest)))
        panels.append(TimePanel(label=signal.label, unit=unit, curves=tuple(curves)))
        if left:
            label = f"{signal.label}, {signal.name} less {signal.modelled}"
            panels.append(TimePanel(label=label, unit=unit, curves=tuple(left), first=True))
    found = {"start": grid.start, "step": grid.step, "count": grid.count}
    return TimeGraph(title=title, alternative=alternative, choices=tuple(choices), panels=tuple(panels), **found)


def numbers_over(graph: TimeGraph, time: Array, values: NDArray[np.integer]) -> str:
    """Numbers (m,) at ascending times - s - (m,) on the grid of a graph, in 16 bits; -1 where no time is near."""
    at = graph.start + graph.step * np.arange(graph.count)
    after = np.clip(np.searchsorted(time, at), 1, time.size - 1)
    nearest = after - (at - time[after - 1] < time[after] - at)
    reach = max(graph.step, float(np.median(np.diff(time))))
    return packed(np.where(np.abs(time[nearest] - at) < reach, values[nearest], -1), "<i2")


def coarser(part: AnyOf, times: int) -> AnyOf:
    """A document, or a part of one, whose graphs over time have intervals that are so many times as long."""
    fields = _within(part, partial(coarser, times=times))
    match part:
        case TimeGraph():
            fields["start"] = part.start + 0.5 * (times - 1) * part.step
            fields |= {"step": times * part.step, "count": math.ceil(part.count / times)}
        case TimeCurve():
            fields["samples"] = _joined(part.samples, times)
        case Panel() if part.bins is not None:
            fields["bins"] = packed(_runs(part.bins, times)[:, times // 2], "<i2")
    return part.model_copy(update=fields)


def thinned(part: AnyOf, every: int) -> AnyOf:
    """A document, or a part of one, whose motions have one of so many instants."""
    fields = _within(part, partial(thinned, every=every))
    match part:
        case Moving():
            position = np.frombuffer(base64.b64decode(part.position), "<f4")[::every]
            fields |= {"step": every * part.step, "count": position.size, "position": packed(position)}
        case ModelRun():
            fields |= {"apart": _some(part.apart, every), "others": tuple(_some(one, every) for one in part.others)}
        case RobotDrawing():
            fields |= {"step": every * part.step, "poses": tuple(_some(one, every) for one in part.poses)}
    return part.model_copy(update=fields)


def _within(part: Part, change: Callable[[Part], Part]) -> dict[str, Any]:
    """Fields of a part that are parts themselves, each changed."""
    fields: dict[str, Any] = {}
    for name, value in part:
        if isinstance(value, Part):
            fields[name] = change(value)
        elif isinstance(value, tuple):
            fields[name] = tuple(change(one) if isinstance(one, Part) else one for one in value)
    return fields


def _some(samples: Samples, every: int) -> Samples:
    """One of so many values."""
    return samples.model_copy(
        update={"low": packed(np.frombuffer(base64.b64decode(samples.low), "<i2")[::every], "<i2")}
    )


def _joined(samples: Samples, times: int) -> Samples:
    """Lowest and highest value of so many intervals each, downwards and upwards in steps that are 2**ROUGH as large."""
    low, high = (_runs(text, times) for text in (samples.low, samples.high or samples.low))
    known = (high != NOTHING).any(axis=1)
    ends = np.where(low == NOTHING, -NOTHING - 1, low).min(axis=1) >> ROUGH, -(-high.max(axis=1) >> ROUGH)
    lowest, highest = (packed(np.where(known, end, NOTHING), "<i2") for end in ends)
    return samples.model_copy(update={"scale": samples.scale * 2**ROUGH, "low": lowest, "high": highest})


def _runs(text: str, times: int) -> NDArray[np.int16]:
    """16-bit numbers in base 64 in rows of so many, the last one of which is filled up."""
    numbers = np.frombuffer(base64.b64decode(text), "<i2")
    return np.pad(numbers, (0, -numbers.size % times), constant_values=NOTHING).reshape(-1, times)
