"""Every signal of a recording over time on one page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from bench.arrays import Array
from bench.errors import InputError
from bench.report.figures import MEASURED, in_style, save_as_named, thinned, title_figure
from bench.trace.channel import Channel, Recording
from bench.trace.choose import of_axis
from bench.trace.reading_options import ReadingOptions
from bench.trace.trace import assemble

#: Rows of a page that can still be read.
MOST = 16


def draw_signals(recording: Recording, how: ReadingOptions, path: Path) -> None:
    """Draw the signals over time, holes as gaps; of a recording that needs a rig, the columns that change over samples.

    Raises:
        InputError: a place that cannot be written to, or a format that is none of a figure.
    """
    try:
        trace = assemble(recording, how)
    except InputError:
        channels = [channel for channel in of_axis(recording, how.axis) if _moves(channel)]
        rows = [
            (np.arange(channel.values.size, dtype=np.float64), channel.values, channel.label) for channel in channels
        ]
        label = "sample"
    else:
        edges = [part.stop for part in trace.segments[:-1]]
        time = np.asarray(np.insert(trace.time, edges, np.nan), dtype=np.float64)
        rows = [
            (time, np.asarray(np.insert(values, edges, np.nan), dtype=np.float64), f"{name} [{trace.units[name]}]")
            for name, values in trace.signals.items()
        ]
        label = "time / s"
    save_as_named(_figure(rows[:MOST], label, Path(recording.origin).name, len(rows) - MOST), path)


def _moves(channel: Channel) -> bool:
    numbers = channel.values[np.isfinite(channel.values)]
    return channel.defect is None and numbers.size > 1 and bool(np.ptp(numbers))


@in_style
def _figure(rows: Sequence[tuple[Array, Array, str]], label: str, title: str, more: int) -> Figure:
    figure = Figure(figsize=(11.0, 1.0 + 1.5 * max(len(rows), 1)), layout="constrained")
    beyond = f" and {more} columns more" if more > 0 else ""
    title_figure(figure, title + beyond)
    grid = figure.subplots(max(len(rows), 1), 1, sharex=True, squeeze=False)
    for axes, (time, values, name) in zip(grid[:, 0], rows, strict=False):
        shown_time, shown = thinned(time, values)
        axes.plot(shown_time, shown, color=MEASURED, lw=0.8)
        axes.set_ylabel(name, rotation=0, ha="right", va="center")
    grid[-1, 0].set_xlabel(label)
    return figure
