"""Draw a chart of the lab: one renderer for every task, for the HTML report and the PDF alike."""

from __future__ import annotations

from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from bench.lab.result import Chart, Curve, Panel

#: Size of a figure - inch: width, and height of one panel or of several.
WIDTH, SINGLE, STACKED = 8.0, 3.9, 7.0
#: Curves of fewer points have larger dots.
FEW = 200
#: First measured, then what is made of it.
COLOURS = ("#4c5c6e", "#d9560b", "#3b7a57", "#7a4a8c", "#b0892b", "#2f7fb5")


def chart_height(chart: Chart) -> float:
    """Height of a chart - inch."""
    return SINGLE if len(chart.panels) == 1 else STACKED


def chart_figure(chart: Chart) -> Figure:
    """Figure of a chart."""
    figure = Figure(figsize=(WIDTH, chart_height(chart)), layout="constrained")
    draw_chart(figure, chart)
    return figure


def draw_chart(figure: Figure | SubFigure, chart: Chart) -> None:
    """Draw a chart: its panels one above the other, those with the first one's x label on its x axis."""
    figure.suptitle(chart.title, x=0.02, ha="left", weight="bold", size="medium")
    axes: list[Axes] = []
    for k, panel in enumerate(chart.panels):
        shared = axes[0] if axes and panel.x_label == chart.panels[0].x_label else None
        axes.append(figure.add_subplot(len(chart.panels), 1, k + 1, sharex=shared))
        below = chart.panels[k + 1].x_label if k + 1 < len(chart.panels) else None
        _draw(axes[k], panel, label_x=below != panel.x_label)


def _draw(axes: Axes, panel: Panel, label_x: bool) -> None:
    colours = COLOURS if len(panel.curves) <= len(COLOURS) else colormaps["tab20"].colors  # pyright: ignore
    for curve, colour in zip(panel.curves, colours, strict=False):
        _draw_curve(axes, curve, colour)
    if panel.log:
        axes.set(xscale="log", yscale="log")
    axes.set_ylabel(panel.y_label)
    axes.tick_params(labelbottom=label_x)
    if label_x:
        axes.set_xlabel(panel.x_label)
    axes.grid(alpha=0.25)
    if any(curve.label for curve in panel.curves):
        axes.legend(loc="best", fontsize="small", frameon=True, framealpha=0.85, ncols=1 + (len(panel.curves) > 4))


def _draw_curve(axes: Axes, curve: Curve, colour: object) -> None:
    label = curve.label or None
    if curve.style == "dots":
        axes.plot(curve.x, curve.y, ".", ms=2.5 if curve.x.size > FEW else 5.0, color=colour, label=label)
    elif curve.style == "bold dots":
        axes.plot(curve.x, curve.y, "o", ms=7.0, color=colour, label=label)
    elif curve.style == "wide":
        axes.plot(curve.x, curve.y, "-", lw=4.0, alpha=0.4, color=colour, label=label)
    else:
        axes.plot(curve.x, curve.y, "--" if curve.style == "dashes" else "-", lw=1.1, color=colour, label=label)
