"""The frequency response of an axis in a page: as measured, as modelled, and its resonance and antiresonance."""

from __future__ import annotations

import numpy as np

from bench.axis_kind import AxisKind
from bench.fit.frequency_response import COHERENT, FrequencyResponse
from bench.plant.axis_model import AxisModel
from bench.plant.linear import speed_over_torque
from bench.report import document as doc
from bench.report.numbers import number, unit_text
from bench.report.parts import parameters_table


def frequency_section(found: FrequencyResponse, model: AxisModel | None, kind: AxisKind) -> doc.Section:
    """Size of the response over frequency with intervals, that of the model, and the coherence."""
    coherent, frequency = found.coherent, found.frequency
    size, reach = np.abs(found.response), 2.0 * np.minimum(found.error, 0.45)
    x, y = frequency[coherent], size[coherent]
    drawn = [doc.series("measured", "dots", "ink", x, y, (y * (1.0 - reach[coherent]), y * (1.0 + reach[coherent])))]
    along = np.geomspace(x.min(), x.max(), 300)
    modelled = None if model is None else speed_over_torque(model, along)
    if modelled is not None:
        drawn.append(doc.series("inertia, viscous friction and coupling", "line", "model", along, np.abs(modelled)))
    unit = f"({unit_text(kind.speed_unit)})/({unit_text(kind.effort_unit)})"
    near = (frequency >= x.min()) & (frequency <= 2.0 * x.max())
    coherence = doc.series("coherence", "line", "violet", frequency[near], np.maximum(found.coherence[near], 1e-2))
    panels = (
        doc.Panel(x_label="", series=tuple(drawn), y_label=f"speed over {kind.effort} / {unit}", log=True),
        doc.Panel(x_label="frequency", x_unit="Hz", series=(coherence,), y_label="coherence", log=True),
    )
    title = "Frequency response"
    about = f"Speed over {kind.effort} at the frequencies that the recording excites, and its coherence."
    every = {"resonance": found.resonance, "antiresonance": found.antiresonance}
    known = {name: one for name, one in every.items() if one is not None}
    text = (
        f"{found.windows} windows were averaged. Drawn are lines with a coherence of {COHERENT:g} or more, with 95 % "
        f"intervals, from {number(float(x.min()), 'Hz', 3)} to {number(float(x.max()), 'Hz', 3)}. Dry friction lowers "
        "the coherence at low frequencies."
    )
    tables = [parameters_table("Of an elastic load", known)] if known else []
    chart = doc.Chart(title=title, alternative=about, panels=panels)
    return doc.section("frequency", title, doc.Paragraph(text=text), chart, *tables, detail=True)
