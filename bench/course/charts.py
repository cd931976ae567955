"""Draw a chart of the lab: one renderer for every task, for the HTML report and the PDF alike."""

from __future__ import annotations

from matplotlib import colormaps, rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from bench.course.result import Chart, Curve, Panel
from bench.names import plain
from bench.report.figures import MEASURED, MODELLED, REST, STYLE, title_figure

#: Size of a figure - inch: width, and height by the number of panels.
WIDTH, HEIGHTS = 8.0, (3.3, 4.6, 5.4, 6.4)
#: Size of the y labels by the number of panels, so that each fits beside its own.
LABELS = ("medium", "small", "x-small", "x-small")
#: Height that a row of the legend takes, and entries in one row.
LEGEND_ROW, LEGEND_COLUMNS = 0.2, 4
#: Curves of fewer points have larger dots.
FEW = 200
#: First measured, then what is made of it.
COLOURS = (MEASURED, MODELLED, REST, "#7a4a8c", "#a07a1e", "#2f7fb5", "#9c2626", "#7d8894")


def chart_height(chart: Chart) -> float:
    """Height of a chart - inch."""
    rows = sum(_legend_rows(panel) for panel in chart.panels)
    return HEIGHTS[min(len(chart.panels), len(HEIGHTS)) - 1] + LEGEND_ROW * max(rows - 1, 0)


def chart_figure(chart: Chart) -> Figure:
    """Figure of a chart."""
    figure = Figure(figsize=(WIDTH, chart_height(chart)), layout="constrained")
    draw_chart(figure, chart)
    return figure


def draw_chart(figure: Figure | SubFigure, chart: Chart) -> None:
    """Draw a chart: its panels one above the other, those with the first one's x label on its x axis."""
    with rc_context(STYLE):
        _draw_panels(figure, chart)


def _draw_panels(figure: Figure | SubFigure, chart: Chart) -> None:
    title_figure(figure, chart.title, x=0.02, size="medium")
    axes: list[Axes] = []
    for k, panel in enumerate(chart.panels):
        shared = axes[0] if axes and panel.x_label == chart.panels[0].x_label else None
        axes.append(figure.add_subplot(len(chart.panels), 1, k + 1, sharex=shared))
        below = chart.panels[k + 1].x_label if k + 1 < len(chart.panels) else None
        size = LABELS[min(len(chart.panels), len(LABELS)) - 1]
        _draw(axes[k], panel, below != panel.x_label, size)
    figure.align_ylabels(axes)


def _draw(axes: Axes, panel: Panel, label_x: bool, label_size: str) -> None:
    colours = COLOURS
    if len(panel.curves) > len(COLOURS):
        colours = colormaps["tab10" if len(panel.curves) <= 10 else "tab20"].colors  # pyright: ignore
    for curve, colour in zip(panel.curves, colours, strict=False):
        _draw_curve(axes, curve, colour)
    if panel.log:
        axes.set(xscale="log", yscale="log")
    axes.set_ylabel(panel.y_label, size=label_size)
    axes.tick_params(labelbottom=label_x)
    if label_x:
        axes.set_xlabel(panel.x_label)
    if _legend_rows(panel):
        # above the axes, where it covers no data
        above = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.1}
        legend = axes.legend(fontsize="x-small", frameon=False, ncols=LEGEND_COLUMNS, **above)
        for text in legend.get_texts():
            text.set_parse_math(False)


def _legend_rows(panel: Panel) -> int:
    return -(-sum(bool(curve.label) for curve in panel.curves) // LEGEND_COLUMNS)


def _draw_curve(axes: Axes, curve: Curve, colour: object) -> None:
    label = plain(curve.label) or None
    if curve.style == "dots":
        axes.plot(curve.x, curve.y, ".", ms=2.5 if curve.x.size > FEW else 5.0, color=colour, label=label)
    elif curve.style == "bold dots":
        axes.plot(curve.x, curve.y, "o", ms=7.0, color=colour, label=label)
    elif curve.style == "reach":
        axes.plot(curve.x, curve.y, "o-", ms=6.0, lw=1.4, markevery=[0], color=colour, label=label)
    elif curve.style == "wide":
        axes.plot(curve.x, curve.y, "-", lw=4.0, alpha=0.4, color=colour, label=label)
    else:
        line, width = {"dashes": ("--", 1.1), "thin": (":", 1.3), "line": ("-", 1.1)}[curve.style]
        axes.plot(curve.x, curve.y, line, lw=width, color=colour, label=label)
