"""Signals and results in a notebook: the `bench.presented.Renderer` of all of them."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib import import_module
from importlib.util import find_spec
from json import loads as parsed
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bench.arrays import Array
from bench.axis_kind import KINDS
from bench.baseline.check import Checked
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.replay import Replay
from bench.errors import InputError
from bench.files import write_text
from bench.fit.estimate import Estimate
from bench.gate.plausible import UNITS
from bench.joints.robot import IdentifiedRobot
from bench.names import nearest, words
from bench.plant.simulate import Simulated
from bench.presented import Size
from bench.report.check import check_document, check_json, over_runs
from bench.report.diagnosis import diagnosis_json, verdict_sentence, write_diagnosis
from bench.report.document import Chart, Colour, Intervals, Panel, Paragraph, Picture, Style, Table, series
from bench.report.gap import at_a_glance, gap_chart
from bench.report.identification import identification, identification_json, moved
from bench.report.numbers import effort_word, sentence, unit_text
from bench.report.parts import parameters_table
from bench.report.servo import servo, servo_json
from bench.report.terminal import rendered
from bench.servos.servo import Servo
from bench.structured import csv_of_texts
from bench.trace.trace import Trace
from bench.trace.write import write

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Columns and lines of a text.
WIDTH, LINES = 100, 25


#: What names all parts of a result but the first, which alone is drawn by default.
REST: dict[type, str] = {Diagnosis: "where", Checked: "runs"}


class Overview(NamedTuple):
    """What a result comes to, its numbers, and all of it as the contract's JSON."""

    headline: str
    tables: list[Table]
    json: str


def overview(result: object) -> Overview:
    """Of any result that is shown."""
    match result:
        case Estimate():
            kind = next((kind for kind in KINDS if kind.inertia in result), KINDS[0])
            headline = f"{sentence(kind.in_words('inertia'))} is not determined."
            if kind.inertia in result:
                headline = identification("", kind, result).verdict
            return Overview(headline, [parameters_table("", result.parameters)], identification_json(result))
        case Diagnosis():
            tables = [parameters_table("The axis", result.parameters)]
            tables += [parameters_table(sentence(words(one.name)), one.parameters) for one in result.effects]
            return Overview(verdict_sentence(result), tables, diagnosis_json(result))
        case Checked():
            document = check_document(result, "")
            tables = [part for section in document.sections for part in section.blocks if isinstance(part, Table)]
            return Overview(document.verdict, tables, check_json(result))
        case Servo():
            document = servo(result, "")
            tables = [part for part in document.sections[0].blocks if isinstance(part, Table)]
            return Overview(document.verdict, tables, servo_json(result))
    raise TypeError(f"nothing is known of {type(result).__name__}")


def json(result: object) -> str:
    """The contract's JSON."""
    return overview(result).json


def content(result: object) -> dict[str, Any]:
    """The same as plain values."""
    return parsed(json(result))


def text(result: object) -> str:
    """The headline, units that were assumed, and as many tables as one screen has room for."""
    headline, tables, _ = overview(result)
    assumed = [check.found for check in getattr(result, "checks", ()) if check.name == UNITS]
    lines = [line for one in (headline, *assumed) for line in str(rendered(Paragraph(text=one), WIDTH)).splitlines()]
    for table in tables:
        more = ["", *str(rendered(table, WIDTH)).splitlines()]
        lines += more if len(lines) + len(more) <= LINES else []
    return "\n".join(lines[:LINES])


def small_page(result: object) -> str:
    """The headline, the picture of a diagnosis and the tables as HTML."""
    headline, tables, _ = overview(result)
    picture = ""
    if isinstance(result, Diagnosis):
        from bench.report.figures import drawn, save_into  # matplotlib: 0.35 s

        image = save_into(drawn(Picture(name="diagnosis", title="", rows=(at_a_glance(result),))))
        source = f"data:image/png;base64,{base64.b64encode(image).decode()}"
        picture = f'<img alt="Measured, before and after" style="max-width:100%" src="{source}">'
    return f"<div><p><strong>{escape(headline)}</strong></p>{picture}{''.join(map(_html, tables))}</div>"


def _html(table: Table) -> str:
    def row(tag: str, cells: Iterable[str]) -> str:
        return f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells)}</tr>"

    caption = f"<caption>{escape(table.caption)}</caption>" if table.caption else ""
    heading = row("th", (column.heading for column in table.columns))
    return f"<table>{caption}{heading}{''.join(row('td', cells) for cells in table.rows)}</table>"


def plot(result: object, names: Sequence[str] = (), ax: Axes | None = None, figsize: Size | None = None) -> Any:  # noqa: ANN401 - axes, or an array of them
    """The parts of a result with these names, each in axes of its own; into given ones the first of them.

    Of a diagnosis `where` names the gap over all coordinates, of a check `runs` all quantities over the runs.
    """
    parts = parts_of(result)
    names = [each for name in names for each in (name if isinstance(name, list | tuple) else [name])]
    if ax is not None and not hasattr(ax, "transAxes"):
        raise InputError("plot(): ax", f"found {ax!r}", "allowed: axes of matplotlib, as plt.subplots() gives them")
    if (rest := REST.get(type(result))) is not None:
        first, *others = parts
        names = [each for name in names or (first,) for each in (others if name == rest else [name])]
    for name in names:
        if name not in parts:
            found = f"found {name!r}{nearest(name, [*parts]) if isinstance(name, str) else ''}"
            raise InputError(f"plot() of {type(result).__name__}", found, f"allowed: {', '.join(parts)}, ax=, figsize=")
    from bench.report.figures import onto

    chosen = [parts[name] for name in names or parts]
    if ax is not None:
        return onto(ax, chosen[0])
    from matplotlib import pyplot

    size = figsize or (7.0, 1.0 + 2.0 * len(chosen))
    every = pyplot.figure(figsize=size, layout="constrained").subplots(len(chosen), 1, squeeze=False)[:, 0]
    for axes, part in zip(every, chosen, strict=True):
        onto(axes, part)
    return every[0] if len(chosen) == 1 else every


def parts_of(result: object) -> dict[str, Panel | Intervals]:
    """What can be drawn of a result, by name."""
    match result:
        case Trace():
            return {name: _over_time(result.time, name, result.units[name], {"": result[name]}) for name in result}
        case Simulated():
            return parts_of(result.trace)
        case Replay():
            units = result.speed_unit, result.effort_unit
            both = {"velocity": (result.velocity, result.velocity_simulated)}
            both |= {"torque": (result.torque, result.torque_simulated)}
            return {
                name: _over_time(result.time, name, unit, {"measured": measured, "simulated": simulated})
                for (name, (measured, simulated)), unit in zip(both.items(), units, strict=True)
                if np.isfinite(simulated).any()
            }
        case Estimate():
            time, effort, left = along(result)
            name, unit = effort_word(result.residual.unit), result.residual.unit
            return {name: _over_time(time, name, unit, {"measured": effort, "modelled": effort - left})}
        case Diagnosis():
            coordinates = [one.coordinate for one in result.where if one.after]
            over = gap_chart(result, coordinates)
            by_name = {name: _labelled(over, panel) for name, panel in zip(coordinates, over.panels, strict=True)}
            return {"gap": _first_of(at_a_glance(result)[-1]), **by_name}
        case Servo():
            (chart,) = servo(result, "").glance
            return {"position": _first_of(chart)}
        case Checked():
            blocks = [part for section in check_document(result, "").sections for part in section.blocks]
            spans = [part for part in blocks if isinstance(part, Intervals)]
            if spans:
                return {"differences": spans[0], **over_runs(result)}
    raise InputError("plot()", f"found {type(result).__name__}", "allowed: what has signals or quantities to draw")


def _first_of(chart: Chart) -> Panel:
    return _labelled(chart, chart.panels[0])


def _labelled(chart: Chart, panel: Panel) -> Panel:
    return panel.model_copy(update={"y_label": f"{chart.y_label} / {chart.y_unit}"})


def _over_time(time: Array, name: str, unit: str, signals: Mapping[str, Array]) -> Panel:
    """Signals of one unit over time, the last of several as the model's."""
    styles: list[tuple[Style, Colour]] = [("wide", "ink"), ("line", "model")]
    drawn = (
        series(label, style, colour, time, values)
        for (label, values), (style, colour) in zip(signals.items(), styles[-len(signals) :], strict=True)
    )
    return Panel(x_label="time", x_unit="s", y_label=f"{words(name)} / {unit_text(unit)}", series=tuple(drawn))


def along(result: object, recording: object = None) -> tuple[Array, Array, Array]:
    """Time, effort and residual of the first recording, or of another, where it moves (m,) each - s, unit, unit."""
    if not isinstance(result, Estimate) or result.of is None or not (result.of[1] or recording):
        found = "found an estimate without its recording"
        raise InputError("plot(), residuals", found, "allowed: one of recordings in memory")
    rig, known = result.of
    first = recording if isinstance(recording, Trace) else known[0]
    (one,) = moved([Path(first.origin)], rig, result, lambda _: first)
    return one.motion.time, one.motion.effort, one.left


def frame(result: object) -> Any:  # noqa: ANN401 - of pandas or polars
    """A row for each sample of signals, or for each quantity."""
    library = next((name for name in ("pandas", "polars") if find_spec(name) is not None), None)
    if library is None:
        raise InputError("to_frame()", "found neither pandas nor polars", "install one of them")
    return import_module(library).DataFrame(columns_of(result))


def columns_of(result: object) -> dict[str, Any]:
    """Of the table of a result, by name."""
    match result:
        case Trace():
            return {"time": result.time, **result.signals}
        case Simulated():
            return columns_of(result.trace)
        case Replay():
            own = ("time", "position", "position_simulated", "velocity", "velocity_simulated")
            return {name: getattr(result, name) for name in (*own, "torque", "torque_simulated")}
        case Checked():
            names = "name", "result", "baseline", "now", "unit", "margin"
            compared = [tuple(getattr(one, name) for name in names) for one in result.comparisons]
            ends = [one.difference95 or (None, None) for one in result.comparisons]
            rows = [(*one, *bounds) for one, bounds in zip(compared, ends, strict=True)]
            return _by_column((*names, "low", "high"), rows)
        case IdentifiedRobot():
            of = {name: joint.parameters for name, joint in result.joints.items()}
        case Diagnosis():
            of = {"axis": result.parameters, **{effect.name: effect.parameters for effect in result.effects}}
        case Estimate() | Servo():
            of = {"axis": result.parameters}
        case _:
            raise TypeError(f"nothing is known of {type(result).__name__}")
    rows = [
        (name, quantity, one.value, one.unit, one.std_error, *one.ci95)
        for name, found in of.items()
        for quantity, one in found.items()
    ]
    return _by_column(("of", "quantity", "value", "unit", "std_error", "low", "high"), rows)


def _by_column(names: Sequence[str], rows: Sequence[tuple[Any, ...]]) -> dict[str, list[Any]]:
    return {name: [row[k] for row in rows] for k, name in enumerate(names)}


def save(result: object, path: Path) -> None:
    """A table of what ends in `.csv`, else a folder of a diagnosis and a file of anything else."""
    match result:
        case Trace():
            write(result, path)
        case Simulated():
            write(result.trace, path)
        case Replay():
            write_text(path, result.csv())
        case _ if path.suffix.lower() == ".csv":
            columns = columns_of(result)
            write_text(path, csv_of_texts([*columns], zip(*columns.values(), strict=True)))
        case Diagnosis():
            write_diagnosis(path, result, path.name)
        case IdentifiedRobot():
            raise InputError("save()", "found IdentifiedRobot", "allowed: write its text, robot.with_joints(folder)[0]")
        case _:
            write_text(path, overview(result).json + "\n")
