"""Figures of an identification, drawn without a display."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from bench.arrays import Array
from bench.axis_kind import AxisKind
from bench.errors import InputError
from bench.files import whole
from bench.identify.estimate import Estimate
from bench.identify.modelled import modelled_effort
from bench.names import plain
from bench.trace.motion import Motion

#: More points than this do not show in a figure; the extremes of each stretch stand for it.
POINTS = 8000
MEASURED, MODELLED, REST = "#4c5c6e", "#d9560b", "#3b7a57"


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure whole or not at all; the ending decides the format."""
    with whole(path) as temporary, quiet_about_glyphs():
        figure.savefig(temporary, dpi=120)


@contextmanager
def quiet_about_glyphs() -> Iterator[None]:
    """No warning for each character that the font lacks: a box stands for it in the figure."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph \d+ ", UserWarning)
        warnings.filterwarnings("ignore", r"Matplotlib currently does not support \w+ natively", UserWarning)
        yield


def title_figure(figure: Figure | SubFigure, title: str, **style: Any) -> None:  # noqa: ANN401
    """Title at the upper left, in which names are text: no formulas, and no characters that an SVG may not hold."""
    figure.suptitle(plain(title), **{"x": 0.01, "ha": "left", "weight": "bold", "parse_math": False, **style})


def save_as_named(figure: Figure, path: Path) -> None:
    """Write a figure to the file a person named.

    Raises:
        InputError: another ending than .png, .pdf or .svg, or a place that cannot be written to.
    """
    if path.suffix.lower() not in (".png", ".pdf", ".svg"):
        raise InputError(path, f"found the ending '{path.suffix}'", "allowed: .png, .pdf, .svg")
    save(figure, path)


def thinned(*columns: Array) -> list[Array]:
    """Columns (m,) at no more than POINTS rows, keeping the extremes of the last column in every stretch."""
    rows = columns[0].size
    if rows <= POINTS:
        return list(columns)
    stretches = np.array_split(np.arange(rows), POINTS // 2)
    last = np.nan_to_num(columns[-1])
    kept = [np.sort([part[np.argmin(last[part])], part[np.argmax(last[part])]]) for part in stretches]
    index = np.unique(np.concatenate(kept))
    return [column[index] for column in columns]


def identification_figure(motion: Motion, estimate: Estimate, kind: AxisKind, title: str) -> Figure:
    """Speed, acceleration, torque measured and modelled, and the residual over speed and time.

    Args:
        motion: filtered recording.
        estimate: what was identified from it.
        kind: of the axis.
        title: of the figure.
    """
    unit, length = estimate.residual.unit, kind.length_unit
    effort = {"N*m": "torque", "N": "force", "A": "current", "V": "voltage"}.get(unit, "effort")
    modelled = modelled_effort(motion, estimate, kind)
    residual = motion.effort - modelled
    figure = Figure(figsize=(11.0, 8.5), layout="constrained")
    title_figure(figure, title)
    grid = figure.add_gridspec(4, 2, width_ratios=(3.0, 1.0), height_ratios=(1.0, 1.0, 1.4, 1.0))
    axes = [figure.add_subplot(grid[0, 0])]
    axes += [figure.add_subplot(grid[row, 0], sharex=axes[0]) for row in (1, 2, 3)]
    over = [figure.add_subplot(grid[:2, 1]), figure.add_subplot(grid[2:, 1])]
    _draw(axes[0], motion.time, motion.velocity, f"speed\n{length}/s")
    _draw(axes[1], motion.time, motion.acceleration, f"acceleration\n{length}/s²")
    _draw(axes[2], motion.time, motion.effort, f"{effort}\n{unit}", label="measured")
    time, shown = thinned(motion.time, modelled)
    axes[2].plot(time, shown, color=MODELLED, lw=0.9, label="modelled")
    axes[2].legend(loc="upper right", ncols=2, frameon=False)
    _draw(axes[3], motion.time, residual, f"residual\n{unit}", color=REST)
    axes[3].set_xlabel("time / s")
    speed, rest = thinned(motion.velocity, residual)
    over[0].plot(speed, rest, ".", ms=1.0, color=REST, alpha=0.4)
    over[0].set(xlabel=f"speed / ({length}/s)", ylabel=f"residual / {unit}")
    over[1].hist(residual[np.isfinite(residual)], bins=80, color=REST)
    over[1].set(xlabel=f"residual / {unit}", ylabel="samples")
    for axis in (*axes, *over):
        axis.grid(alpha=0.25)
    return figure


def _draw(
    axis: Axes,
    time: Array,
    values: Array,
    label_y: str,
    color: str = MEASURED,
    label: str | None = None,
) -> None:
    shown_time, shown = thinned(time, values)
    axis.plot(shown_time, shown, color=color, lw=0.9, label=label)
    axis.set_ylabel(label_y)
