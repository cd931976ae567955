"""Confusion matrix: hidden effect against name given."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from bench.validation.independent.effects import CATALOGUE, LATER
from tests.outside import OUTSIDE
from tests.studies.blind.score import Score, twins

NOTHING, REMAINDER, REFUSED = "nothing", "remainder only", "refused"
NONE_HIDDEN = "nothing hidden"


def columns() -> list[str]:
    """Names that can be given, then what there is besides."""
    return [*CATALOGUE, *LATER, NOTHING, REMAINDER, REFUSED]


def given(score: Score) -> list[str]:
    """Columns that a case counts in: each name it was given, or what was said instead."""
    if score.outcome.refused:
        return [REFUSED]
    if score.outcome.named:
        return list(score.outcome.named)
    return [REMAINDER if score.outcome.verdict == "unexplained_remainder" else NOTHING]


def counted(scores: Sequence[Score]) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Rows (single effects, nothing, physics outside), cases named so (rows, columns), and cases in all (rows,)."""
    rows = [*CATALOGUE, NONE_HIDDEN, *OUTSIDE]
    names = columns()
    matrix, cases = np.zeros((len(rows), len(names)), dtype=int), np.zeros(len(rows), dtype=int)
    for score in scores:
        if score.group in ("single", "null", "outside"):
            row = rows.index(score.hidden or NONE_HIDDEN)
            cases[row] += 1
            for name in given(score):
                matrix[row, names.index(name)] += 1
    used = cases > 0
    return [row for row, keep in zip(rows, used, strict=True) if keep], matrix[used], cases[used]


def right_columns(row: str, without_truth: bool) -> set[str]:
    """Columns in which a row is right."""
    if row == NONE_HIDDEN:
        return {NOTHING, REMAINDER}
    if row in OUTSIDE or without_truth:
        return {REMAINDER}
    return set(twins(row))


def confusion_figure(scores: Sequence[Score], title: str, without_truth: bool = False) -> Figure:
    """Counts, coloured by share of the row; outlined where a row is right."""
    rows, matrix, cases = counted(scores)
    names = columns()
    figure = Figure(figsize=(13.0, 2.6 + 0.36 * len(rows)), layout="constrained")
    axis = figure.subplots()
    share = matrix / np.maximum(cases, 1)[:, None]
    axis.imshow(share, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for row, column in zip(*np.nonzero(matrix), strict=True):
        colour = "white" if share[row, column] > 0.6 else "black"
        axis.text(column, row, str(matrix[row, column]), ha="center", va="center", color=colour, fontsize=9)
    for row, hidden in enumerate(rows):
        for name in right_columns(hidden, without_truth):
            corner = (names.index(name) - 0.5, row - 0.5)
            axis.add_patch(Rectangle(corner, 1.0, 1.0, fill=False, edgecolor="tab:green", lw=1.4))
    axis.set_xticks(range(len(names)), [name.replace("_", " ") for name in names], rotation=55, ha="left")
    axis.set_yticks(range(len(rows)), [f"{r.replace('_', ' ')} ({n})" for r, n in zip(rows, cases, strict=True)])
    axis.xaxis.tick_top()
    axis.set_ylabel("hidden (cases)")
    axis.set_xlabel("named; green: right")
    axis.tick_params(length=0)
    for edge in ("top", "bottom", "left", "right"):
        axis.spines[edge].set_visible(False)
    for border in (len(CATALOGUE) - 0.5,):
        axis.axvline(border, color="0.6", lw=0.8)
    singles = sum(row in CATALOGUE for row in rows)
    if 0 < singles < len(rows):
        axis.axhline(singles - 0.5, color="0.6", lw=0.8)
    figure.suptitle(title, x=0.01, ha="left", weight="bold")
    return figure


def save_confusion(path: Path, scores: Sequence[Score], title: str, without_truth: bool = False) -> None:
    """Write the figure."""
    confusion_figure(scores, title, without_truth).savefig(path, dpi=110)
