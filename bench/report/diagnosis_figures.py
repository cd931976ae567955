"""Figures of a diagnosis: where the gap sits with what was found drawn into it, and how it shrinks."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from bench.diagnosis.found import Gap, Profile
from bench.diagnosis.show.show import Diagnosis
from bench.diagnosis.where.where import Where
from bench.names import words
from bench.report.figures import MEASURED, MODELLED, NOISE, REST, in_style, legend_above, title_figure
from bench.report.numbers import coordinate_word, number, share, unit_text

#: Empty space beside the outermost dots of a gap - factor on a logarithmic axis.
BESIDE = 1.5


@in_style
def where_figure(diagnosis: Diagnosis, title: str) -> Figure:
    """The gap against each coordinate before and after, what the found effects make of it, and the noise floor.

    All coordinates have one scale; the spectrum beside them has a scale of its own.
    """
    figure = Figure(figsize=(12.0, 6.4), layout="constrained")
    title_figure(figure, title)
    places = [figure.add_subplot(2, 4, k + 1) for k in range(len(diagnosis.profiles) + 1)]
    for axes, profile in zip(places, diagnosis.profiles, strict=False):
        axes.sharey(places[0])
        _draw(axes, profile, diagnosis)
    spectrum = next(account for account in diagnosis.where if account.coordinate == "frequency")
    _spectrum(places[-1], spectrum, diagnosis)
    handles, labels = places[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _draw(axes: Axes, profile: Profile, diagnosis: Diagnosis) -> None:
    order = np.argsort(profile.centres)
    x, before, after = profile.centres[order], profile.before[order], profile.after[order]
    floor = diagnosis.torque.noise_floor
    axes.axhspan(-floor, floor, color=NOISE, lw=0.0, zorder=0.5, label="noise floor")
    axes.plot(x, before, "o", ms=3.2, color=MEASURED, label="gap before")
    if diagnosis.effects:
        names = " and ".join(words(effect.name) for effect in diagnosis.effects)
        axes.plot(x, before - after, color=MODELLED, lw=1.3, label=f"what {names} makes of it")
        axes.plot(x, after, "o", ms=3.0, mfc="white", mew=0.9, color=REST, label="left after")
    axes.set_title(f"{share(profile.share)} of the gap", loc="right")
    axes.set_xlabel(_labelled(coordinate_word(profile.coordinate, profile.unit), profile.unit))
    place = axes.get_subplotspec()
    if place is not None and place.is_first_col():
        axes.set_ylabel(f"gap / {unit_text(diagnosis.torque.unit)}")
    else:
        axes.tick_params(labelleft=False)


def _spectrum(axes: Axes, account: Where, diagnosis: Diagnosis) -> None:
    axes.plot(account.centres[1:], account.means[1:], color=MEASURED)
    axes.set_title(f"{share(account.share)} of the gap in one band", loc="right")
    axes.set_xlabel("frequency / Hz")
    axes.set_ylabel(f"gap before / ({unit_text(diagnosis.torque.unit)}/√Hz)")


def _labelled(name: str, unit: str) -> str:
    shown = unit_text(unit)
    return f"{name} / {f'({shown})' if '/' in shown else shown}" if shown else name


@in_style
def gaps_figure(diagnosis: Diagnosis, title: str) -> Figure:
    """Torque and velocity gap of the bare axis and after each addition, on both recordings, against the noise floor."""
    figure = Figure(figsize=(12.0, 1.5 + 0.32 * len(diagnosis.steps)), layout="constrained")
    title_figure(figure, title)
    labels = ["inertia, friction", *(f"+ {words(step.effect)}" for step in diagnosis.steps[1:])]
    gaps = ("torque", diagnosis.torque), ("velocity", diagnosis.velocity)
    for axes, (name, gap) in zip(figure.subplots(1, 2), gaps, strict=True):
        values = np.array([getattr(step, name) for step in diagnosis.steps])
        _dots(axes, values, gap)
        axes.set_yticks(np.arange(len(labels)), labels)
        axes.set_xlabel(f"RMS {name} gap / {_labelled('', gap.unit).removeprefix(' / ')}")
    return figure


def _dots(axes: Axes, values: np.ndarray, gap: Gap) -> None:
    """Gaps (steps, recordings) as dots on a logarithmic axis, their figures beside it, where nothing crosses them."""
    places, floor = np.arange(len(values)), gap.noise_floor
    for k, (recording, colour, marker) in enumerate((("recording", MEASURED, "o"), ("holdout", MODELLED, "D"))):
        if k < values.shape[1]:
            axes.plot(values[:, k], places, marker, ms=6.0, color=colour, label=recording)
    axes.axvline(floor, color="#8a94a0", lw=1.2, ls="--", zorder=0.8, label="noise floor")
    for place, row in zip(places, values, strict=True):
        figures = "  ".join(number(value, digits=3) if math.isfinite(value) else "–" for value in row)
        beside = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points", "va": "center", "fontsize": 8}
        axes.annotate(figures, (1.0, place), (6.0, 0.0), **beside)
    shown = values[np.isfinite(values) & (values > 0.0)]
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.3g}"))
    axes.xaxis.set_minor_locator(NullLocator())
    if shown.size and floor > 0.0:
        axes.set_xlim(min(shown.min(), floor) / BESIDE, max(shown.max(), floor) * BESIDE)
    axes.set_ylim(len(values) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")
    legend_above(axes)
