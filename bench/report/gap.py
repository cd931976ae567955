"""The gap between measured and modelled: drawn over time and coordinates, its RMS, and the remaining residual in words.

Of the residual: its shape, the closest effects, the reasons against them, and what to record to decide.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.tabulated import UNKNOWN
from bench.diagnosis.where import Where
from bench.names import words
from bench.report import document as doc
from bench.report.numbers import coordinate_word, effort_word, listed, number, sentence, share, unit_text
from bench.report.over_time import numbers_over
from bench.report.parts import noise_band, one_panel
from bench.report.verdict import reason

#: Empty space around the outermost gaps - factor on a logarithmic axis.
SPACE = 1.5
#: A recording is cut so often for a stretch that shows the gap; a longer one is as good with this share of the best.
CUTS, NEARLY = (2, 4, 8, 16, 32), 0.7
#: Of a stretch: samples at least, and points that are drawn at most.
LEAST, POINTS = 60, 400
#: Coordinates of the gap, by those of a table.
TABULATED = {"position": "position", "speed": "velocity", "torque": "current"}
#: Share of all that it spans which a stretch does at least: at standstill, steps of its sensor are all there is.
MOVES = 0.05


def at_a_glance(found: Diagnosis) -> tuple[doc.Chart, ...]:
    """Measured and modelled over a stretch that shows the gap, and the gap over the coordinate that it depends on.

    Without a named effect that is the coordinate of an unknown one, where there is a table of it.
    """
    profiles = {one.coordinate: one for one in found.where if one.after}
    of_table = found.unknown_effect.over[0] if found.unknown_effect and not found.effects else ""
    most = profiles.get(TABULATED.get(of_table, ""), next(iter(profiles.values())))
    over = gap_chart(found, [most.coordinate])
    panels = tuple(panel.model_copy(update={"note": ""}) for panel in over.panels)
    title = f"{share(most.share)} of the gap depends on {panels[0].x_label}."
    over = over.model_copy(update={"title": title, "alternative": "", "panels": panels})
    return tuple(filter(None, (_stretch_chart(found), over)))


def _stretch_chart(found: Diagnosis) -> doc.Chart | None:
    """Measured, before and after over the stretch that shows the gap best; None of a recording too short for one."""
    series, best, chart = found.time_series[0], 0.0, None
    named = len(found.steps) - (1 if found.unknown_effect else 0) - 1
    for what, unit, rows, measured, residuals in (
        (effort_word(found.torque.unit), found.torque.unit, series.rows, series.torque, series.torque_residuals),
        ("speed", found.velocity.unit, np.arange(series.time.size), series.velocity, series.velocity_residuals),
    ):
        known = [one for one in (residuals[0], *residuals[named:]) if one is not None]
        if len(known) < len(residuals[named:]) + 1:
            continue
        curves = np.stack([measured, *(measured - one for one in known)])
        score, part = _telling(curves[:3], _whole(rows, curves[:3]))
        if part is None or (chart is not None and score <= best):
            continue
        few = slice(part.start, part.stop, -(-(part.stop - part.start) // POINTS))
        time, (measured, before, after, *tabulated) = series.time[rows[few]], curves[:, few]
        drawn = [doc.series("measured", "wide", "ink", time, measured)]
        drawn.append(doc.series("inertia and friction", "dashes", "blue", time, before))
        if (before != after).any():
            drawn.append(doc.series("with the effects found", "line", "model", time, after))
        drawn += [doc.series(f"with the {unknown_effect(found)}", "line", "violet", time, one) for one in tabulated]
        best, chart = score, one_panel(f"{sentence(what)} in detail.", "", ("time", "s"), (what, unit), drawn)
    return chart


def _whole(rows: NDArray[np.int64], curves: Array) -> list[slice]:
    """Stretches without a hole of samples (m,) and of curves (3, m) at them."""
    step = np.diff(rows)
    unknown = np.isnan(curves.sum(axis=0))
    broken = (step > step.min(initial=rows.size)) | unknown[1:] | unknown[:-1]
    ends = [0, *(np.flatnonzero(broken) + 1).tolist(), rows.size]
    return [slice(start, stop) for start, stop in pairwise(ends)]


def _telling(curves: Array, whole: Sequence[slice]) -> tuple[float, slice | None]:
    """The longest stretch in which the effects are nearly as large a part of the motion as anywhere, and that part."""
    ranked: list[tuple[float, slice]] = []
    least = MOVES * float(np.ptp(curves[:, ~np.isnan(curves.sum(axis=0))])) if whole else 0.0
    for cut in CUTS:
        size = max(LEAST, curves.shape[1] // cut)
        for part in whole:
            for start in range(part.start, part.stop - size + 1, max(1, size // 4)):
                here = slice(start, start + size)
                measured, before, after = curves[:, here]
                difference = before - after if (before != after).any() else measured - before
                ranked.append((rms(difference) / max(float(np.ptp(curves[:, here])), least, 1e-300), here))
    best = max((score for score, _ in ranked), default=0.0)
    return next(((score, part) for score, part in ranked if score >= NEARLY * best), (0.0, None))


def unknown_effect(found: Diagnosis) -> str:
    """An unknown effect in words: `unknown effect, tabulated over position`; empty without one."""
    one = found.unknown_effect
    return "" if one is None else f"unknown effect, tabulated over {listed(one.over)}"


def gap_chart(found: Diagnosis, coordinates: Sequence[str], over: doc.TimeGraph | None = None) -> doc.Chart:
    """The gap in bins of these coordinates, the part that the effects explain, the residual, and the noise of a row.

    `over`: graph of the recording over time, in which the page shows when it was in a bin.
    """
    profiles = {one.coordinate: one for one in found.where if one.after}
    most = next(iter(profiles.values()))
    explained = listed(dict.fromkeys(words(effect.name) for effect in found.effects))
    panels = []
    for profile in (profiles[name] for name in coordinates if name in profiles):
        order = np.argsort(profile.centres)
        x, before, after, *tabulated = (v[order] for v in (profile.centres, profile.means, *profile.after))
        drawn = [noise_band(x.tolist(), found.torque.noise_floor), doc.series("gap", "dots", "ink", x, before)]
        if found.effects and profile.curve is not None:
            drawn.append(doc.series(f"{explained}, fitted", "line", "model", *profile.curve))
            drawn.append(doc.series("remaining residual", "rings", "residual", x, after))
        drawn += [doc.series(unknown_effect(found), "line", "violet", x, after - one) for one in tabulated]
        panels.append(
            doc.Panel(
                x_label=coordinate_word(profile.coordinate, profile.unit),
                x_unit=unit_text(profile.unit),
                note=f"{share(profile.share)} of the gap",
                series=tuple(drawn),
                bins=None if over is None or profile.bins is None else _bins_over(over, found, profile.bins, order),
            )
        )
    return doc.Chart(
        title="The gap, and the effects found in it.",
        alternative=f"Mean of measured less modelled {effort_word(found.torque.unit)} in bins of each coordinate; "
        "torque that the filter takes from the effects is added. "
        f"Most of it depends on {most.coordinate}, {share(most.share)} of its variance.",
        y_label="gap",
        y_unit=unit_text(found.torque.unit),
        panels=tuple(panels),
    )


def _bins_over(graph: doc.TimeGraph, found: Diagnosis, bins: NDArray[np.integer], order: NDArray[np.integer]) -> str:
    """Which of the bins, in this order of them (b,), contains each interval of a graph of the recording."""
    series, place = found.time_series[0], np.append(np.argsort(order), -1)  # the last one of rows in none
    return numbers_over(graph, series.time[series.rows], place[bins])


def where_picture(found: Diagnosis, title: str) -> doc.Picture:
    """The gap over all coordinates on one scale, and its spectrum on a scale of its own."""
    spectrum = next(account for account in found.where if account.coordinate == "frequency")
    panel = doc.Panel(
        x_label="frequency",
        x_unit="Hz",
        y_label=f"gap / ({unit_text(found.torque.unit)}/√Hz)",
        note=f"{share(spectrum.share)} of the gap in one band",
        series=(doc.series("", "line", "ink", spectrum.centres[1:], spectrum.means[1:]),),
    )
    over = gap_chart(found, [one.coordinate for one in found.where])
    below = doc.Chart(title="", alternative="Spectrum of the gap.", panels=(panel,))
    return doc.Picture(name="where", title=title, rows=((over,), (below,)))


def rms_gaps(found: Diagnosis) -> tuple[doc.Intervals, ...]:
    """RMS gaps that are known of the bare axis and after each addition, on both recordings, against the noise floor."""
    charts = []
    for what, gap, steps in (
        (effort_word(found.torque.unit), found.torque, [step.torque for step in found.steps]),
        ("speed", found.velocity, [step.velocity for step in found.steps]),
    ):
        spans = [
            doc.Span(name=f"{label}, {series.name}", colour=colour, value=value, low=value, high=value)
            for label, values in zip(states(found), steps, strict=True)
            for series, colour, value in zip(found.time_series, ("ink", "model"), values, strict=False)
            if math.isfinite(value) and value > 0.0
        ]
        if not spans or not gap.noise_floor > 0.0:
            continue
        ends = [gap.noise_floor, *(span.value for span in spans)]
        limits = min(ends) / SPACE, max(ends) * SPACE
        charts.append(
            doc.Intervals(
                title=f"{sentence(what)} gap.",
                alternative="RMS gaps before and after each addition; the band is noise.",
                label=f"RMS {what} gap",
                unit=unit_text(gap.unit),
                right=(limits[0], gap.noise_floor),
                limits=limits,
                spans=tuple(spans),
                log=True,
            )
        )
    return tuple(charts)


def states(found: Diagnosis) -> list[str]:
    """The bare axis, then each addition, an unknown effect last."""
    names = [unknown_effect(found) if step.effect == UNKNOWN else words(step.effect) for step in found.steps[1:]]
    return ["inertia and friction", *(f"+ {name}" for name in names)]


#: A region is narrow, or near zero, within this share of what was seen; a trend and a wave are clear from this share.
NARROW, CLEAR = 0.15, 0.6
#: Suspects that are named, and the least share of the residual worth a word.
NEAREST, WORTH = 2, 0.01
#: By coordinate: what to record, and the command for it.
DECIDES = {
    "position": ("the whole travel slowly, both ways: what stays at its place is the axis'", "diagnose slow.csv"),
    "velocity": ("steady speeds, eight or more both ways: they draw friction over speed", "friction speeds.csv"),
    "reversal": ("slow reversals with the position, sampled faster: they show how it breaks away", "diagnose slow.csv"),
    "time": ("the same motion cold and warm: what comes back is no warming", "diagnose cold.csv warm.csv"),
    "direction": ("the same motion with the axis turned over: what turns with it is gravity", "diagnose turned.csv"),
    "frequency": ("another speed: a frequency that moves along is of the shaft, one that stays of drive or frame",
                  "diagnose faster.csv"),
}  # fmt: skip
OTHERWISE = (
    "half and twice the acceleration: what grows with torque is of motor, gear or sensor",
    "diagnose half.csv twice.csv",
)


def remainder(found: Diagnosis) -> Iterator[str]:
    """Sentences about the remaining residual; none where it is noise."""
    if not found.unexplained_where:
        return
    shapes = [f"{shape(one)} ({share(one.share)} of it)" for one in found.unexplained_where if one.share >= WORTH]
    if shapes:
        yield f"Remaining residual: {'; '.join(shapes)}."
    parts = [(one.of_residual if found.effects else one.of_gap, one) for one in found.considered if not one.accepted]
    near = sorted(((part, one) for part, one in parts if part and part >= WORTH), key=lambda pair: -pair[0])[:NEAREST]
    nearest = [f"{words(one.effect.name)}, {share(part)} of it, but {reason(one.reason)}" for part, one in near]
    yield (
        f"Closest effects of the catalogue: {'; '.join(nearest)}."
        if nearest
        else "No effect of the catalogue explains much of it."
    )
    record, command = DECIDES.get(found.unexplained_where[0].coordinate, OTHERWISE)
    yield f"To decide, record {record}: bench {command} --rig RIG."


def shape(one: Where) -> str:
    """How the residual depends on a coordinate, in words."""
    (low, high), centres, name = one.region, one.centres, coordinate_word(one.coordinate, one.unit)
    between = f"between {number(low, digits=3)} and {number(high, one.unit, 3)}"
    reach, size = float(np.ptp(centres)), float(np.abs(centres).max())
    narrow = high - low <= NARROW * reach
    match one.coordinate:
        case "frequency":
            return f"an oscillation of {number(0.5 * (low + high), one.unit, 3)}"
        case "direction":
            return "it differs between the directions"
        case "reversal" if high <= NARROW * reach:
            return f"spikes at each breakaway, within {number(high, one.unit, 3)} of a reversal"
        case "velocity" if max(abs(low), abs(high)) <= NARROW * size:
            return f"around standstill, {between}"
        case "time" if abs(trend := float(np.corrcoef(centres, np.abs(one.means))[0, 1])) >= CLEAR:
            return "it grows with time" if trend > 0.0 else "it fades with time"
        case "position" if (length := _wave(centres, one.means)) > 0.0:
            return f"a wave of {number(length, one.unit, 3)}"
        case _ if narrow:
            return f"at one {name}, {between}"
    return f"it changes with {name}, most {between}"


def _wave(x: Array, y: Array) -> float:
    """Length of the wave that is most of y (b,) over x (b,); 0 where none is."""
    y, reach, best = y - y.mean(), float(np.ptp(x)), (0.0, 0.0)
    for waves in range(1, x.size // 4 + 1):
        phase = 2.0 * np.pi * waves * x / reach
        columns = np.column_stack([np.sin(phase), np.cos(phase)])
        rest = y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]
        best = max(best, (1.0 - float(rest @ rest) / max(float(y @ y), 1e-300), reach / waves))
    return best[1] if best[0] >= CLEAR else 0.0
