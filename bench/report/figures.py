"""The one style of all figures, and how they are written; drawn without a display, for a screen or for paper."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from bench.arrays import Array
from bench.errors import InputError
from bench.files import whole
from bench.names import plain

P = ParamSpec("P")

#: More points than this do not show in a figure; the extremes of each stretch stand for it.
POINTS = 8000
#: What is measured, what a model makes, what is left, and noise: the same everywhere, and told apart in grey too.
MEASURED, MODELLED, REST, NOISE = "#4c5c6e", "#c0480a", "#25704e", "#d6e0e8"
#: How every figure is set: text stays text in SVG and PDF, no box around the axes, a grid that recedes.
STYLE: dict[Any, Any] = {
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#8a94a0",
    "axes.linewidth": 0.8,
    "xtick.color": "#55616d",
    "ytick.color": "#55616d",
    "xtick.labelcolor": "#1c232b",
    "ytick.labelcolor": "#1c232b",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dfe4e9",
    "grid.linewidth": 0.7,
    "lines.linewidth": 1.0,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "savefig.dpi": 140,
}
#: Endings of a figure's file.
FORMATS = (".png", ".pdf", ".svg")


def in_style(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """A function that draws a figure, in the style of all."""

    @wraps(draw)
    def drawn(*args: P.args, **named: P.kwargs) -> Figure:
        with rc_context(STYLE):
            return draw(*args, **named)

    return drawn


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure whole or not at all; the ending decides the format."""
    with whole(path) as temporary, quiet_about_glyphs(), rc_context(STYLE):
        figure.savefig(temporary)


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


def legend_above(axes: Axes) -> None:
    """A legend over the axes, where it covers no data; its names are text."""
    legend = axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1, ncols=4)
    for text in legend.get_texts():
        text.set_parse_math(False)


def save_as_named(figure: Figure, path: Path) -> None:
    """Write a figure to the file a person named.

    Raises:
        InputError: another ending than .png, .pdf or .svg, or a place that cannot be written to.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(path, f"found the ending '{path.suffix}'", f"allowed: {', '.join(FORMATS)}")
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
