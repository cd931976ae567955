"""The figure of an identification: the motion, torque measured and modelled, what is left, and the estimates."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bench.arrays import Array
from bench.axis_kind import AxisKind
from bench.fit.estimate import Estimate
from bench.fit.modelled import modelled_effort
from bench.names import words
from bench.report.figures import MEASURED, MODELLED, NOISE, REST, in_style, legend_above, thinned, title_figure
from bench.report.page.numbers import interval, unit_text
from bench.report.pages.tables import effort_word
from bench.trace.motion import Motion


@in_style
def identification_figure(motion: Motion, estimate: Estimate, kind: AxisKind, title: str) -> Figure:
    """Speed, acceleration, torque measured and modelled, the residual over speed and time, and the estimates.

    Args:
        motion: filtered recording.
        estimate: what was identified from it.
        kind: of the axis.
        title: of the figure.
    """
    unit, length = unit_text(estimate.residual.unit), unit_text(kind.length_unit)
    effort = effort_word(estimate.residual.unit)
    modelled = modelled_effort(motion, estimate, kind)
    residual = motion.effort - modelled
    figure = Figure(figsize=(11.0, 8.5), layout="constrained")
    title_figure(figure, title)
    grid = figure.add_gridspec(4, 2, width_ratios=(3.0, 1.15), height_ratios=(1.0, 1.0, 1.4, 1.0))
    axes = [figure.add_subplot(grid[0, 0])]
    axes += [figure.add_subplot(grid[row, 0], sharex=axes[0]) for row in (1, 2, 3)]
    over = [figure.add_subplot(grid[2, 1]), figure.add_subplot(grid[3, 1])]
    _write_numbers(figure.add_subplot(grid[:2, 1]), estimate)
    _draw(axes[0], motion.time, motion.velocity, f"speed\n{length}/s")
    _draw(axes[1], motion.time, motion.acceleration, f"acceleration\n{length}/s²")
    time, shown = thinned(motion.time, motion.effort)
    axes[2].plot(time, shown, color=MEASURED, alpha=0.55, lw=2.4, label="measured")
    axes[2].set_ylabel(f"{effort}\n{unit}")
    time, shown = thinned(motion.time, modelled)
    axes[2].plot(time, shown, color=MODELLED, label="modelled")
    legend_above(axes[2])
    _noise(axes[3], estimate)
    _draw(axes[3], motion.time, residual, f"residual\n{unit}", color=REST)
    axes[3].set_xlabel("time / s")
    for axis in axes[:3]:
        axis.tick_params(labelbottom=False)
    speed, rest = thinned(motion.velocity, residual)
    _noise(over[0], estimate)
    over[0].plot(speed, rest, ".", ms=1.5, color=REST, alpha=0.5, rasterized=True)
    over[0].set(xlabel=f"speed / ({length}/s)", ylabel=f"residual / {unit}")
    over[1].hist(residual[np.isfinite(residual)], bins=80, color=REST)
    over[1].set(xlabel=f"residual / {unit}", ylabel="samples")
    over[1].xaxis.set_major_locator(MaxNLocator(3))
    figure.align_ylabels(axes)
    return figure


def _write_numbers(axes: Axes, estimate: Estimate) -> None:
    """The estimates with their intervals, as text."""
    axes.set_axis_off()
    lines = [f"{words(name)}\n    {interval(found)}" for name, found in estimate.parameters.items()]
    if math.isfinite(estimate.residual.noise_floor):
        lines.append(f"residual over noise floor\n    {estimate.residual.rms / estimate.residual.noise_floor:.3g}")
    axes.text(0.0, 1.0, "\n".join(lines), va="top", linespacing=1.45, transform=axes.transAxes, parse_math=False)


def _noise(axes: Axes, estimate: Estimate) -> None:
    floor = estimate.residual.noise_floor
    if math.isfinite(floor):
        axes.axhspan(-floor, floor, color=NOISE, lw=0.0, zorder=0.5)


def _draw(axis: Axes, time: Array, values: Array, label_y: str, color: str = MEASURED) -> None:
    shown_time, shown = thinned(time, values)
    axis.plot(shown_time, shown, color=color)
    axis.set_ylabel(label_y)
