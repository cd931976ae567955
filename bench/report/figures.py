"""Pictures of a document, in the one style of all figures; drawn without a display, for a screen or for paper."""

from __future__ import annotations

import textwrap
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context, rc_params_from_file
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

from bench.arrays import Array
from bench.errors import InputError
from bench.files import whole
from bench.names import plain
from bench.report import document as doc
from bench.report.over_time import unpacked

#: More points than this do not show in a figure; the extremes of each stretch stand for it.
POINTS = 8000
#: What is measured, a model, a residual, and noise: the same everywhere, and distinct in grey too.
MEASURED, MODELLED, REST, NOISE = "#4c5c6e", "#c0480a", "#25704e", "#d6e0e8"
#: Colours of a document on paper.
COLOURS = {"ink": MEASURED, "model": MODELLED, "residual": REST, "floor": NOISE, "first": "#7d8894"}
COLOURS |= {"violet": "#7a4a8c", "ochre": "#a07a1e", "blue": "#2f7fb5", "red": "#9c2626"}
#: How every figure is set.
STYLE = rc_params_from_file(Path(__file__).parent / "page" / "figures.mplstyle", use_default_template=False)
#: Decorates what draws a figure.
in_style = rc_context(STYLE)
#: Endings of a figure's file.
FORMATS = (".png", ".pdf", ".svg")
#: Width of a picture, and height of its title - inch.
WIDTH, TITLE = 11.0, 0.35
#: Panels of a chart next to each other, intervals of the axis of each of more than two, and height of a row - inch.
ACROSS, NARROW, ROW = 4, 5, 2.4
#: Height of a panel over time, of one of a stack, of a row of intervals and of one of a table - inch.
TIME_PANEL, STACKED, SPAN, LINE = 1.5, 1.6, 0.3, 0.2
#: Letters across a legend over its axes, those that the sample of a line takes, and across a title.
LETTERS, OF_SAMPLE, OF_TITLE = 130, 8, 110
#: Entries in a row of a legend, and dots that are few enough to be larger.
LEGEND, FEW = 4, 200
#: How a series is drawn.
DRAWN: dict[str, dict[str, Any]] = {
    "dots": {"marker": "o", "ls": "", "ms": 2.5},
    "large dots": {"marker": "o", "ls": "", "ms": 7.0},
    "rings": {"marker": "o", "ls": "", "ms": 3.2, "mfc": "white", "mew": 0.9},
    "line": {"lw": 1.2},
    "dashes": {"ls": "--", "lw": 1.1},
    "dotted": {"ls": ":", "lw": 1.3},
    "wide": {"lw": 4.0, "alpha": 0.4},
}
#: The same of curves over time, by their role.
ROLES: dict[str, dict[str, Any]] = {
    "measured": {"color": MEASURED, "alpha": 0.55, "lw": 2.4},
    "model": {"color": MODELLED},
    "residual": {"color": REST},
    "alone": {"color": MEASURED},
}


@in_style
def drawn(picture: doc.Picture) -> Figure:
    """The figure of a picture: its rows from top to bottom, the parts of a row next to each other."""
    heights = [max(drawing(part)[0] for part in row) for row in picture.rows]
    figure = Figure(figsize=(WIDTH, TITLE + sum(heights)), layout="constrained")
    title_figure(figure, picture.title)
    rows = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    for place, row in zip(rows, picture.rows, strict=True):
        row = [row[0], *(_unnamed(part, row[0]) for part in row[1:])]
        widths = [0.4 if isinstance(part, doc.Table) else 1.0 for part in row]
        for beside, part in zip(place.subfigures(1, len(row), width_ratios=widths, squeeze=False)[0], row, strict=True):
            drawing(part)[1](beside, part)
    return figure


def _unnamed(part: doc.Drawable, first: doc.Drawable) -> doc.Drawable:
    """A part of a row; intervals of the same names as the first one's without them."""
    if not (isinstance(part, doc.Intervals) and isinstance(first, doc.Intervals)):
        return part
    if [span.name for span in part.spans] != [span.name for span in first.spans]:
        return part
    return part.model_copy(update={"spans": tuple(span.model_copy(update={"name": ""}) for span in part.spans)})


def drawing(part: doc.Drawable) -> tuple[float, Callable[..., None]]:
    """Height that a part takes - inch -, and what draws it into a figure, in the style that is set."""
    match part:
        case doc.Table():
            return 0.4 + 2.0 * LINE * len(part.rows), _write
        case doc.TimeGraph():
            return 0.5 + TIME_PANEL * len(part.panels), _over_time
        case doc.Intervals():
            return 1.0 + SPAN * len(part.spans), _intervals
        case doc.HeatMap():
            return 2.6 + 0.34 * len(part.rows), _heat
        case doc.Chart() if part.stacked:
            named = [[one.name for one in panel.series if one.name] for panel in part.panels]
            legends = sum(-(-len(names) // across(names)) for names in named)
            return max(3.0, 0.8 + STACKED * len(part.panels)) + LINE * legends, _stacked
        case doc.Chart():
            return 0.4 + ROW * (-(-len(part.panels) // ACROSS) if len(part.panels) > 1 else 1.6), _side_by_side


def _write(figure: Figure | SubFigure, table: doc.Table) -> None:
    """A table as text: what a row is of, and its cells below."""
    axes = figure.subplots()
    axes.set_axis_off()
    lines = [f"{row[0]}\n    {' '.join(filter(None, row[1:]))}" for row in table.rows]
    axes.text(0.0, 1.0, plain("\n".join(lines)), va="top", linespacing=1.45, transform=axes.transAxes, parse_math=False)


def _over_time(figure: Figure | SubFigure, graph: doc.TimeGraph) -> None:
    """All panels, with the model chosen last, and the one chosen first with it where it stays in sight."""
    last = len(graph.choices) - 1
    every = figure.subplots(len(graph.panels), 1, sharex=True, squeeze=False)[:, 0]
    for axes, panel in zip(every, graph.panels, strict=True):
        kept = {None, last, 0 if panel.first or not graph.choices else last}
        for curve in panel.curves:
            if curve.choice in kept:
                low, high = unpacked(curve.samples)
                time = graph.start + graph.step * np.arange(low.size, dtype=np.float64)
                style = ROLES["alone" if len(panel.curves) == 1 and curve.role == "measured" else curve.role]
                faded = {"color": COLOURS["first"]} if curve.choice == 0 < last else {}
                axes.plot(*_extent(time, low, high), label=plain(curve.name), **style | faded)
        unit = f"\n{panel.unit}" if panel.unit else ""
        axes.set_ylabel(plain(panel.label.replace(", ", ",\n") + unit), parse_math=False)
        if len(panel.curves) > 1:
            legend_above(axes)
    every[-1].set_xlabel("time / s")
    figure.align_ylabels(every)


def _extent(time: Array, low: Array, high: Array) -> list[Array]:
    """A line that goes through lowest and highest value of each interval (n,), thinned."""
    if not np.array_equal(low, high, equal_nan=True):
        time, low = np.repeat(time, 2), np.column_stack([low, high]).ravel()
    return thinned(time, low)


def _side_by_side(figure: Figure | SubFigure, chart: doc.Chart) -> None:
    """Panels next to each other on one y scale, under one legend."""
    across = min(len(chart.panels), ACROSS)
    rows = -(-len(chart.panels) // across)
    every = figure.subplots(rows, across, sharey=True, squeeze=False).ravel()
    for place, axes in enumerate(every):
        if place >= len(chart.panels):
            axes.set_axis_off()
            continue
        _panel(axes, chart.panels[place])
        if across > 2 and not chart.panels[place].log:  # so many labels of four digits have room
            axes.locator_params(axis="x", nbins=NARROW)
        if place % across == 0:
            axes.set_ylabel(plain(_labelled(chart.y_label, chart.y_unit)), parse_math=False)
    handles, labels = every[0].get_legend_handles_labels()
    if handles:
        wide = figure.bbox.width > 0.8 * WIDTH * figure.dpi  # and no other chart next to it
        legend = figure.legend(handles, labels, loc="outside upper right", ncols=LEGEND if wide else LEGEND // 2)
        _as_text(legend.get_texts())


def _stacked(figure: Figure | SubFigure, chart: doc.Chart) -> None:
    """Panels one above the other; those with the first one's x label on its x axis."""
    title_figure(figure, chart.title, x=0.02, size="medium")
    size = ("medium", "small", "x-small")[min(len(chart.panels), 3) - 1]
    every: list[Axes] = []
    for place, panel in enumerate(chart.panels):
        shared = every[0] if every and panel.x_label == chart.panels[0].x_label else None
        every.append(figure.add_subplot(len(chart.panels), 1, place + 1, sharex=shared))
        _panel(every[-1], panel)
        _own_scale(every[-1], panel, size)
        below = chart.panels[place + 1].x_label if place + 1 < len(chart.panels) else None
        if below == panel.x_label:
            every[-1].tick_params(labelbottom=False)
            every[-1].set_xlabel("")
    figure.align_ylabels(every)


def onto(axes: Axes, part: doc.Panel | doc.Intervals) -> Axes:
    """Draw a panel, or intervals, into axes of somebody's own figure."""
    with rc_context(STYLE):
        if isinstance(part, doc.Intervals):
            _spans(axes, part)
        else:
            _panel(axes, part)
            _own_scale(axes, part, most=2)
    return axes


def _own_scale(axes: Axes, panel: doc.Panel, size: str = "medium", most: int = LEGEND) -> None:
    """Label and legend of a panel that shares neither."""
    axes.set_ylabel(plain(panel.y_label), size=size, parse_math=False)
    if any(one.name for one in panel.series):
        legend_above(axes, most)


def _panel(axes: Axes, panel: doc.Panel) -> None:
    for one in panel.series:
        colour, label = COLOURS[one.colour], plain(one.name) or None
        if one.style == "band":
            axes.fill_between(one.x, one.low, one.high, color=colour, lw=0.0, zorder=0.5, label=label)
            continue
        if one.low:
            axes.vlines(one.x, one.low, one.high, color=colour, lw=1.2)
        style = dict(DRAWN[one.style])
        if one.style == "dots" and len(one.x) < FEW:
            style["ms"] = 3.8
        axes.plot(one.x, one.y, color=colour, label=label, **style)
    if panel.log:
        axes.set(xscale="log", yscale="log")
    if panel.counted:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_title(plain(panel.note), loc="right", parse_math=False)
    axes.set_xlabel(plain(_labelled(panel.x_label, panel.x_unit)), parse_math=False)


def _intervals(figure: Figure | SubFigure, block: doc.Intervals) -> None:
    _spans(figure.subplots(), block)


def _spans(axes: Axes, block: doc.Intervals) -> None:
    """Rows with their values next to the axis, where nothing crosses them."""
    places = np.arange(len(block.spans))
    low, high = block.right
    if low < high:
        axes.axvspan(low, high, color=NOISE, lw=0.0, zorder=0.5)
    else:
        axes.axvline(low, color="#8a94a0", lw=1.2, zorder=0.8)
    for place, span in zip(places, block.spans, strict=True):
        axes.plot((span.low, span.high), (place, place), color=COLOURS[span.colour], lw=1.4)
        axes.plot(span.value, place, "o", ms=5.0, color=COLOURS[span.colour])
        beside = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points", "va": "center", "fontsize": 8}
        axes.annotate(f"{span.value:.3g}".replace("-", "−"), (1.0, float(place)), (6.0, 0.0), **beside)
    if block.log:
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.3g}"))
        axes.xaxis.set_minor_locator(NullLocator())
    axes.set(xlim=block.limits, ylim=(len(places) - 0.5, -0.5))
    _as_text(axes.set_yticks(places, [plain(span.name) for span in block.spans]) and axes.get_yticklabels())
    axes.set_xlabel(plain(_labelled(block.label, block.unit)), parse_math=False)
    axes.set_title(plain(block.title), loc="left", parse_math=False)
    axes.grid(visible=False, axis="y")


def _heat(figure: Figure | SubFigure, block: doc.HeatMap) -> None:
    """Counts, coloured by their share of the row; the right answers, on the diagonal, are framed."""
    axes, counts = figure.subplots(), np.array(block.counts).reshape(len(block.rows), len(block.columns))
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    axes.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for row, column in zip(*np.nonzero(counts), strict=True):
        colour = "white" if shares[row, column] > 0.6 else "black"
        axes.text(column, row, str(counts[row, column]), ha="center", va="center", color=colour, fontsize=8)
    for place in range(len(block.rows)):
        axes.add_patch(Rectangle((place - 0.5, place - 0.5), 1.0, 1.0, fill=False, edgecolor="#1c232b", lw=1.2))
    axes.set_xticks(range(len(block.columns)), list(map(plain, block.columns)), rotation=55, ha="left")
    axes.set_yticks(range(len(block.rows)), list(map(plain, block.rows)))
    _as_text([*axes.get_xticklabels(), *axes.get_yticklabels()])
    axes.xaxis.tick_top()
    axes.set_ylabel(f"{block.corner}; the right answer is framed")
    axes.tick_params(length=0)
    axes.grid(visible=False)


def _labelled(name: str, unit: str) -> str:
    return f"{name} / {f'({unit})' if '/' in unit else unit}" if unit else name


def save(figure: Figure, path: Path) -> None:
    """Write a figure whole or not at all; the ending decides the format.

    Raises:
        InputError: another ending than .png, .pdf or .svg, or a place that cannot be written to.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(path, f"found the ending '{path.suffix}'", f"allowed: {', '.join(FORMATS)}")
    with whole(path) as temporary:
        if path.suffix.lower() == ".png":
            _save_png(figure, temporary)
        else:
            with quiet_about_glyphs(), rc_context(STYLE):
                figure.savefig(temporary)


def save_into(figure: Figure) -> bytes:
    """A figure as PNG."""
    image = BytesIO()
    _save_png(figure, image)
    return image.getvalue()


def _save_png(figure: Figure, to: Path | BytesIO) -> None:
    """Draw once, where `savefig` goes through all artists a time before to lay them out: a quarter more."""
    dots, figure.dpi = figure.dpi, STYLE["savefig.dpi"]
    with quiet_about_glyphs(), rc_context(STYLE):
        FigureCanvasAgg(figure).print_png(to)
    figure.dpi = dots


@contextmanager
def quiet_about_glyphs() -> Iterator[None]:
    """No warning for each character that the font lacks: a box replaces it in the figure."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph \d+ ", UserWarning)
        warnings.filterwarnings("ignore", r"Matplotlib currently does not support \w+ natively", UserWarning)
        yield


def title_figure(figure: Figure | SubFigure, title: str, **style: Any) -> None:  # noqa: ANN401
    """Title at the upper left, in which names are text: no formulas, and no characters that an SVG may not hold."""
    style = {"x": 0.01, "ha": "left", "weight": "bold", "parse_math": False, **style}
    figure.suptitle(textwrap.fill(plain(title), OF_TITLE), **style)


def across(names: Sequence[str], most: int = LEGEND) -> int:
    """How many of these names, at most so many, have room next to each other in a legend."""
    return max(1, min(most, LETTERS // (max(map(len, names), default=0) + OF_SAMPLE)))


def legend_above(axes: Axes, most: int = LEGEND) -> None:
    """A legend over the axes, where it covers no data, with as many names across as fit; its names are text."""
    columns = across(axes.get_legend_handles_labels()[1], most)
    legend = axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1, ncols=columns)
    _as_text(legend.get_texts())


def _as_text(labels: Sequence[Any]) -> None:
    """Labels in which nothing is a formula."""
    for label in labels:
        label.set_parse_math(False)


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
