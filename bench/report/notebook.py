"""Results in a notebook: the `bench.presented.Renderer` of an estimate, a diagnosis or a check."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable
from html import escape
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from bench.axis_kind import KINDS
from bench.baseline.check import Checked
from bench.diagnosis.diagnosis import Diagnosis
from bench.errors import InputError
from bench.files import write_text
from bench.fit.estimate import Estimate
from bench.gate.plausible import UNITS
from bench.names import words
from bench.report.check import check_document, check_json
from bench.report.diagnosis import diagnosis_json, verdict_sentence, write_diagnosis
from bench.report.document import Panel, Paragraph, Picture, Table, series
from bench.report.gap import at_a_glance
from bench.report.identification import identification, identification_json, moved
from bench.report.numbers import effort_word, sentence, unit_text
from bench.report.parts import parameters_table
from bench.report.servo import servo, servo_json
from bench.report.terminal import rendered
from bench.servos.servo import Servo

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Columns and lines of a text.
WIDTH, LINES = 100, 25


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


def content(result: object) -> dict[str, Any]:
    """The contract's JSON as plain values."""
    return json.loads(overview(result).json)


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


def plot(result: object, axes: Axes | None = None) -> Axes:
    """An estimate: measured and modelled effort over time. A diagnosis: the gap and what was found in it."""
    if isinstance(result, Diagnosis):
        chart = at_a_glance(result)[-1]
        panel = chart.panels[0].model_copy(update={"y_label": f"{chart.y_label} / {chart.y_unit}"})
    elif isinstance(result, Estimate):
        panel = _along(result)
    else:
        raise InputError("plot()", f"found {type(result).__name__}", "allowed: an estimate or a diagnosis")
    from bench.report.figures import onto

    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.figure(figsize=(7.0, 3.0), layout="constrained").subplots()
    return onto(axes, panel)


def _along(estimate: Estimate) -> Panel:
    """Effort of the first recording, as measured and as the estimate has it."""
    if estimate.of is None or not estimate.of[1]:
        raise InputError("plot()", "found no recording beside the estimate", "allowed: one of recordings in memory")
    rig, (first, *_) = estimate.of
    (one,) = moved([Path(first.origin)], rig, estimate, lambda _: first)
    time, unit, effort = one.motion.time, estimate.residual.unit, one.motion.effort
    drawn = (
        series("measured", "wide", "ink", time, effort),
        series("modelled", "line", "model", time, effort - one.left),
    )
    return Panel(x_label="time", x_unit="s", y_label=f"{effort_word(unit)} / {unit_text(unit)}", series=drawn)


def frame(result: object) -> Any:  # noqa: ANN401 - of pandas or polars
    """A row for each quantity."""
    library = next((name for name in ("pandas", "polars") if find_spec(name) is not None), None)
    if library is None:
        raise InputError("to_frame()", "found neither pandas nor polars", "install one of them")
    of: list[tuple[str, Any]] = [("axis", result)] if isinstance(result, Estimate | Diagnosis | Servo) else []
    of += [(effect.name, effect) for effect in result.effects] if isinstance(result, Diagnosis) else []
    columns = ("of", "quantity", "value", "unit", "std_error", "low", "high")
    rows = [
        (name, quantity, one.value, one.unit, one.std_error, *one.ci95)
        for name, found in of
        for quantity, one in found.parameters.items()
    ]
    return import_module(library).DataFrame({name: [row[k] for row in rows] for k, name in enumerate(columns)})


def save(result: object, path: Path) -> None:
    """A folder of a diagnosis, a file of anything else."""
    if isinstance(result, Diagnosis):
        write_diagnosis(path, result, path.name)
    else:
        write_text(path, overview(result).json + "\n")
