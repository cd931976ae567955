"""The page of an identification: inertia and friction, how sure that is, and what the model leaves of the torque."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, VISCOUS, AxisKind
from bench.diagnosis.name.rules import Remainder
from bench.diagnosis.where.where import LEAST, bins_of, means_in
from bench.fit.estimate import Estimate
from bench.fit.modelled import modelled_effort
from bench.names import words
from bench.report.page.blocks import Answer, Axes, Chart, Downloads, File, Page, Section, Series, answered
from bench.report.page.numbers import interval, number, share, unit_text
from bench.report.page.scripted import TimeGraph
from bench.report.pages.over_time import Measured, time_graph
from bench.report.pages.tables import (
    checks_section,
    effort_word,
    noise_band,
    origin,
    parameters_table,
    recordings_table,
)
from bench.trace.motion import Motion

#: Recordings whose motion is drawn; of more, the first ones.
DRAWN = 6


def identification_page(
    title: str,
    kind: AxisKind,
    estimate: Estimate,
    motions: Sequence[tuple[str, Motion, Estimate]],
    files: Sequence[File] = (),
    provenance: Mapping[str, Any] | None = None,
) -> Page:
    """The page of an identification.

    Args:
        title: rig and recordings.
        kind: of the axis.
        estimate: what was identified.
        motions: name, filtered motion and estimate along it, of each recording.
        files: to take along.
        provenance: of the files it came from.
    """
    graphs = [_over_time(name, moved, along, kind, min(len(motions), DRAWN)) for name, moved, along in motions[:DRAWN]]
    tables = [parameters_table("The axis", estimate.parameters)]
    if estimate.recordings:
        units = {name: found.unit for name, found in estimate.parameters.items()}
        tables.append(recordings_table(estimate.recordings, estimate.between, units))
    sections = [
        Section(key="parameters", heading="Parameters", blocks=tuple(tables)),
        Section(key="motion", heading="Measured and modelled", blocks=tuple(graphs)),
        Section(key="where", heading="Where the rest sits", blocks=(_rest(estimate, motions, kind),)),
        checks_section(estimate.checks, estimate.warnings),
    ]
    if files:
        sections.append(Section(key="files", heading="The numbers", blocks=(Downloads(files=tuple(files)),)))
    return Page(
        title=title,
        subject=f"Identification of {title}",
        verdict=_verdict(estimate, kind),
        tone="open" if _stands_out(estimate) else "sure",
        answers=_answers(estimate, kind),
        sections=tuple(sections),
        origin=origin(provenance),
    )


def _times_noise(estimate: Estimate) -> float:
    """What is left over the noise floor; nan where the estimator knows none."""
    return estimate.residual.rms / estimate.residual.noise_floor


def _stands_out(estimate: Estimate) -> bool:
    return _times_noise(estimate) > Remainder().chi


def _verdict(estimate: Estimate, kind: AxisKind) -> str:
    effort, chi = effort_word(estimate.residual.unit), _times_noise(estimate)
    line = f"The {kind.in_words(INERTIA)} is {interval(estimate[kind.parameter(INERTIA)])}"
    if math.isfinite(estimate.explained):
        explained = math.floor(1e4 * estimate.explained) / 100.0
        line += f"; inertia and friction explain {explained:g} % of the {effort}'s variance"
    if not math.isfinite(chi):
        return f"{line}."
    if _stands_out(estimate):
        return f"{line}, but what is left is {number(chi, digits=2)} times the noise."
    return f"{line}, and what is left is noise."


def _answers(estimate: Estimate, kind: AxisKind) -> tuple[Answer, ...]:
    residual, friction = estimate.residual, []
    for term in (COULOMB, VISCOUS):
        name = kind.parameter(term)
        if name in estimate.parameters:
            friction.append(f"{words(name)} {interval(estimate[name])}")
    sure = "Half widths are those of 95 % intervals that count correlated residuals."
    if estimate.between:
        sure += " They count how the recordings differ, too."
    effort = effort_word(residual.unit)
    left = f"{number(residual.rms, residual.unit, 3)} RMS, {share(residual.relative)} of the {effort}"
    if math.isfinite(residual.noise_floor):
        left += f"; noise alone would leave {number(residual.noise_floor, digits=3)}"
    following = (
        "bench diagnose: something is in this axis beside inertia and friction, and it says what."
        if _stands_out(estimate)
        else "Nothing stands out of the noise; a recording of other motion would confirm it."
    )
    answers = {
        f"{words(kind.parameter(INERTIA)).capitalize()}?": f"{interval(estimate[kind.parameter(INERTIA)])} (95 %)",
        "Friction?": "; ".join(friction) or "not determined",
        "How sure?": sure,
        "What is left?": f"{left}.",
        "What next?": following,
    }
    return answered(answers)


def _over_time(name: str, moved: Motion, along: Estimate, kind: AxisKind, graphs: int) -> TimeGraph:
    effort, unit = effort_word(along.residual.unit), along.residual.unit
    left = moved.effort - modelled_effort(moved, along, kind)
    signals = [
        Measured("speed", kind.speed_unit, moved.time, moved.velocity),
        Measured(effort, unit, moved.time, moved.effort, [left], "modelled"),
    ]
    alternative = (
        f"Speed of {name}, its {effort} as measured and as inertia and friction make it, and what is left of it."
    )
    return time_graph("Over time.", alternative, moved.time, signals, (), 1.0 / graphs)


def _rest(estimate: Estimate, motions: Sequence[tuple[str, Motion, Estimate]], kind: AxisKind) -> Chart:
    """What is left of the torque over speed, acceleration, torque and time."""
    unit = estimate.residual.unit
    moved = [moved for _, moved, _ in motions]
    left = np.concatenate([each.effort - modelled_effort(each, along, kind) for _, each, along in motions])
    known = np.isfinite(left)
    over = {
        ("speed", kind.speed_unit): [each.velocity for each in moved],
        ("acceleration", kind.acceleration_unit): [each.acceleration for each in moved],
        (effort_word(unit), unit): [each.effort for each in moved],
        ("time", "s"): [each.time - each.time[0] for each in moved],
    }
    panels = [
        _over(name, of, np.concatenate(values)[known], left[known], estimate.residual.noise_floor)
        for (name, of), values in over.items()
    ]
    return Chart(
        title="What is left.",
        alternative=f"Mean of measured less modelled {effort_word(unit)} in bins; what stands out of the noise floor "
        "has a cause beside inertia and friction.",
        y_label="left",
        y_unit=unit_text(unit),
        panels=tuple(panels),
    )


def _over(name: str, unit: str, values: Array, left: Array, floor: float) -> Axes:
    index = bins_of(values)
    kept = np.bincount(index) >= LEAST
    x, y = means_in(index, values)[kept], means_in(index, left)[kept]
    dots = Series(name="left", style="dots", colour="left", x=tuple(x.tolist()), y=tuple(y.tolist()))
    band = [noise_band(dots.x, floor)] if math.isfinite(floor) else []
    return Axes(x_label=name, x_unit=unit_text(unit), series=(*band, dots))
