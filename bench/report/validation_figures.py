"""Figures of a validation: coverage with its bounds, and which names are given for what is hidden."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from bench.report.confusion import Confusion
from bench.report.figures import MEASURED, MODELLED, REST, title_figure
from bench.validation.coverage import LEVELS, Coverage
from bench.validation.naming import Naming

#: Frame of the right answer.
RIGHT = "#1c232b"
COLOURS = {"inertia": MEASURED, "viscous": MODELLED, "coulomb": REST}
SYMBOLS = {"inertia": "J", "viscous": "$K_\\omega$", "coulomb": "$K_0$"}


def coverage_figure(found: Sequence[Coverage]) -> Figure:
    """Share of intervals that hold the truth, of J, K_w and K_0 by groups of runs, with bounds of 95 %."""
    shown = [each for each in found if each.quantity in COLOURS and each.told]
    groups = list(dict.fromkeys((each.by, each.group) for each in shown))
    figure = Figure(figsize=(11.0, 1.8 + 0.36 * max(len(groups), 1)), layout="constrained")
    title_figure(figure, "How often an interval holds the truth")
    axes = figure.subplots(1, len(LEVELS), sharey=True)
    for place, (axis, level) in enumerate(zip(axes, LEVELS, strict=True)):
        for step, quantity in enumerate(COLOURS):
            those = [each for each in shown if each.quantity == quantity]
            rows = np.array([groups.index((each.by, each.group)) for each in those]) + 0.22 * (step - 1)
            shares = [each.inside[place] for each in those]
            value = np.array([share.value for share in shares])
            bounds = np.array([share.bounds for share in shares]).reshape(-1, 2)
            reach = np.abs(bounds.T - value)
            axis.errorbar(
                value, rows, xerr=reach, fmt="o", ms=3.5, lw=1.0, color=COLOURS[quantity], label=SYMBOLS[quantity]
            )
        axis.axvline(level, color="0.3", lw=0.8)
        axis.set_xlabel(f"in its {level:.0%} interval")
        axis.grid(alpha=0.25)
    axes[0].set_yticks(range(len(groups)), [f"{by}: {group}" for by, group in groups])
    axes[0].invert_yaxis()
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper right", ncols=3, frameon=False)
    return figure


def confusion_figure(found: Naming) -> Figure:
    """Names given for each effect that is hidden alone, and where nothing is; coloured by share of what a row says."""
    matrix = Confusion.of(found.confusion)
    rows, columns = matrix.counts.shape
    figure = Figure(figsize=(3.4 + 0.42 * columns, 2.6 + 0.34 * rows), layout="constrained")
    title_figure(figure, "Named, by what is hidden")
    axis = figure.subplots()
    axis.imshow(matrix.shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for row, column in zip(*np.nonzero(matrix.counts), strict=True):
        colour = "white" if matrix.shares[row, column] > 0.6 else "black"
        count = str(matrix.counts[row, column])
        axis.text(column, row, count, ha="center", va="center", color=colour, fontsize=8)
    for row in range(rows):
        axis.add_patch(Rectangle((row - 0.5, row - 0.5), 1.0, 1.0, fill=False, edgecolor=RIGHT, lw=1.2))
    axis.set_xticks(range(columns), matrix.said, rotation=55, ha="left")
    axis.set_yticks(range(rows), matrix.hidden)
    axis.xaxis.tick_top()
    axis.set_ylabel("hidden; the right answer is framed")
    axis.tick_params(length=0)
    axis.grid(visible=False)
    return figure
