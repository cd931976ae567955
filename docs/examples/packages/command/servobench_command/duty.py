"""How hard an axis works: the share of a recording in which it is at rest, and its RMS effort."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from bench.cli.common import JsonOption, ReportOption, RigOption, tell, write_json, write_page
from bench.report.document import Chart, Document, Panel, Section, series, table
from bench.report.numbers import effort_word, number, share, unit_text
from bench.report.parts import origin
from bench.report.serial import serialised

#: Speed below which it is at rest, as a share of the fastest: well above the noise of an encoder's speed.
AT_REST = 0.01


@dataclass(frozen=True)
class Duty:
    """How hard an axis works.

    Attributes:
        at_rest: share of the samples in which it is at rest.
        rms: effort - `unit`.
        unit: of the effort.
    """

    at_rest: float
    rms: float
    unit: str


def duty_of(trace, rig):
    """Duty of a recording."""
    effort, unit = rig.effort(trace)
    speed = np.abs(trace["velocity"])
    return Duty(float(np.mean(speed < AT_REST * speed.max())), float(np.sqrt(np.mean(effort**2))), unit)


def document(found, trace, title):
    """The document of a duty."""
    effort = effort_word(found.unit)
    rows = [("at rest", share(found.at_rest), ""), (f"RMS {effort}", number(found.rms), unit_text(found.unit))]
    fastest = np.sort(np.abs(trace["velocity"]))[::-1]
    drawn = series("speed", "line", "ink", np.linspace(0.0, 100.0, fastest.size)[::50], fastest[::50])
    chart = Chart(
        title="Speed, the fastest first.",
        alternative="How much of the recording is faster than each speed.",
        y_label="speed",
        y_unit=unit_text(trace.units["velocity"]),
        panels=(Panel(x_label="of the recording", x_unit="%", series=(drawn,)),),
    )
    return Document(
        title=title,
        subject=f"Duty of {title}",
        verdict=f"It is at rest for {share(found.at_rest)} of the time; its RMS {effort} is "
        f"{number(found.rms, found.unit)}.",
        tone="sure",
        answers={"From what?": f"{trace.time.size} samples."},
        sections=(
            Section(key="duty", heading="Duty", blocks=(table("All of it", ("of", "value>", "unit"), rows),)),
            Section(key="speed", heading="Speed", blocks=(chart,)),
        ),
        origin=origin(None),
    )


def duty(
    trace: Annotated[Path, typer.Argument(help="Recording of any known format.")],
    rig: RigOption,
    json: JsonOption = None,
    report: ReportOption = None,
) -> None:
    """Report how hard an axis works in a recording."""
    import bench

    axis = bench.load_rig(rig)
    recording = bench.read(trace, axis.trace)
    found = duty_of(recording, axis)
    shown = document(found, recording, trace.name)
    write_page(report, shown)
    write_json(json, lambda: serialised({"schema": "extras.duty/1", "duty": found}))
    tell(shown, [report], json)
