"""Torque over speed that a log reaches: the limits with intervals, and the lines that simulators take.

As JSON (`bench.limits/1`) and as a document.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bench.axis_kind import AxisKind
from bench.parameter import Parameter
from bench.report import document as doc
from bench.report.numbers import interval, number, sentence
from bench.report.parts import one_panel, origin, parameters_table
from bench.report.serial import serialised
from bench.rig.envelope import Envelope

SCHEMA = "bench.limits/1"
#: What to record where a limit was not reached.
NEXT_PEAK = "command large steps of speed in both directions"
NEXT_VOLTAGE = "command a speed that the axis cannot reach, three times or more"


def envelope_json(found: Envelope, kind: AxisKind) -> str:
    """Largest torque over speed, and the limits with intervals that the log determines."""
    return serialised(
        {
            "schema": SCHEMA,
            "parameters": limits_of(found, kind),
            "stretches": {"peak": found.at_peak, "voltage": found.at_voltage},
            "largest": {"unit": kind.effort_unit, "value": found.largest},
            "fastest": {"unit": kind.speed_unit, "value": found.fastest},
            "speed": {"unit": kind.speed_unit, "values": found.speed},
            "reached": {"unit": kind.effort_unit, "values": found.reached},
        }
    )


def limits_of(found: Envelope, kind: AxisKind) -> dict[str, Parameter]:
    """The limits that the log reaches, by name."""
    every = {
        f"peak_{kind.effort}": found.peak,
        "no_load_speed": found.no_load,
        "corner_speed": found.corner,
        "slope": found.slope,
    }
    return {name: value for name, value in every.items() if value is not None}


def envelope_document(found: Envelope, title: str, kind: AxisKind, ratio: float) -> doc.Document:
    """The document of what a log reaches; `ratio`: motor turns per turn of the joint."""
    known = limits_of(found, kind)
    chart = _chart(found, kind)
    reached = [name for name, held in (("current", found.peak), ("voltage", found.no_load)) if held is not None]
    verdict = f"The log reaches the limit of {' and of '.join(reached)}." if reached else "The log reaches no limit."
    tables = [parameters_table("Limits", known)] if known else []
    return doc.Document(
        title=f"{title}: limits",
        subject=f"Torque over speed that {title} reaches" if kind.turns else f"Force over speed that {title} reaches",
        verdict=verdict,
        tone="sure" if reached else "open",
        answers=dict(_answers(found, kind)),
        sections=(
            doc.section("range", f"{sentence(kind.effort)} over speed", *tables, chart),
            doc.section("simulators", "For simulators", *_simulators(found, ratio)),
        ),
        origin=origin(None),
        pictures=(doc.Picture(name="limits", title="", rows=((chart,),)),),
    )


def _answers(found: Envelope, kind: AxisKind) -> Iterator[tuple[str, str]]:
    if found.peak is not None:
        held = f"{interval(found.peak)}, reached in {found.at_peak} stretches; the drive's limit if more was requested"
        yield f"Largest {kind.effort}?", f"{held}."
    else:
        yield (
            f"Largest {kind.effort}?",
            f"At least {number(found.largest, kind.effort_unit, 3)}; the log has no stretch at a limit.",
        )
    if found.no_load is not None:
        line = f"{interval(found.no_load)}, from {found.at_voltage} stretches in which the {kind.effort} falls"
        yield "No-load speed?", f"{line} along one straight line."
    else:
        fastest = number(found.fastest, kind.speed_unit, 3)
        yield "No-load speed?", f"More than {fastest}; the log does not reach the limit of the voltage."
    if found.corner is not None:
        yield "Corner?", f"{interval(found.corner)}: above it the voltage limits the {kind.effort}."
    missing = [text for text, one in ((NEXT_PEAK, found.peak), (NEXT_VOLTAGE, found.no_load)) if one is None]
    if missing:
        yield "What next?", f"For what is missing, {'; and '.join(missing)}: `bench limits harder.csv`."
    else:
        yield "What next?", 'Copy the lines of "For simulators" into your model.'


def _chart(found: Envelope, kind: AxisKind) -> doc.Chart:
    drawn = [doc.series("largest while driving", "dots", "ink", found.speed, found.reached)]
    end = found.fastest if found.no_load is None else max(found.fastest, found.no_load.value)
    along = np.linspace(0.0, end, 200)
    if found.peak is not None:
        drawn.append(doc.series("largest of all", "dashes", "violet", along, np.full_like(along, found.peak.value)))
    if found.slope is not None and found.no_load is not None:
        falling = np.maximum(found.slope.value * (found.no_load.value - along), 0.0)
        shown = falling <= 1.1 * found.largest
        drawn.append(doc.series("limit of the voltage", "line", "model", along[shown], falling[shown]))
    names = (kind.effort, kind.effort_unit)
    about = f"Largest {kind.effort} over speed, and the limits that the log reaches."
    return one_panel(f"{sentence(kind.effort)} over speed", about, ("speed", kind.speed_unit), names, drawn)


def _simulators(found: Envelope, ratio: float) -> Iterator[doc.Paragraph | doc.Code]:
    """Lines to copy, on the joint's side of the gear; only of limits that the log reaches."""
    if found.peak is None:
        yield doc.Paragraph(text="None: a limit that the log does not reach would make the simulated motor too weak.")
        return
    peak = found.peak.value * ratio
    yield doc.Paragraph(text="At the joint. MuJoCo (torque only):")
    yield doc.Code(
        text=f'<motor joint="JOINT" ctrlrange="-{peak:.4g} {peak:.4g}" forcerange="-{peak:.4g} {peak:.4g}"/>'
    )
    if found.stall is not None and found.no_load is not None:
        values = f"effort_limit={peak:.4g}, saturation_effort={found.stall * ratio:.4g}"
        yield doc.Paragraph(text="Isaac Lab's DCMotorCfg and mjlab's DcMotorActuatorCfg (torque over speed):")
        yield doc.Code(text=f"{values}, velocity_limit={found.no_load.value / ratio:.4g}")
