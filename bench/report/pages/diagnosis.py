"""The page of a diagnosis: what was missing, how sure that is, and whether the simulation moves as the axis does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bench.arrays import Array
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.found import Course, Profile
from bench.diagnosis.where.where import Where
from bench.names import words
from bench.report.document import (
    Chart,
    Document,
    Downloads,
    File,
    Heading,
    Panel,
    Paragraph,
    Points,
    Section,
    Series,
    Table,
    TimeGraph,
)
from bench.report.numbers import coordinate_word, effort_word, number, sentence, share, unit_text
from bench.report.over_time import Plotted, time_graph
from bench.report.pages.verdict import answers, following, verdict_sentence
from bench.report.parts import checks_section, noise_band, origin, parameters_table, recordings_table

#: Coordinates of the gap that are drawn; the table has all.
DRAWN = ("position", "velocity", "current", "time")
#: Additions drawn over time at most, the last ones: more would be no page any more.
STEPS = 6


def diagnosis_page(
    diagnosis: Diagnosis, title: str, files: Sequence[File], provenance: Mapping[str, Any] | None = None
) -> Document:
    """The page of a diagnosis.

    Args:
        diagnosis: what was found.
        title: rig and recordings.
        files: to take along: the model.
        provenance: of the files it came from.
    """
    explained = diagnosis.verdict != "unexplained_remainder"
    sections = [
        _motion(diagnosis),
        _where(diagnosis),
        _parameters(diagnosis),
        _suspects(diagnosis),
        _next(diagnosis),
        checks_section(diagnosis.checks, diagnosis.warnings),
        Section(key="model", heading="The model", blocks=(Downloads(files=tuple(files)),)),
    ]
    return Document(
        title=title,
        subject=f"Diagnosis of {title}",
        verdict=verdict_sentence(diagnosis),
        tone="sure" if explained else "open",
        answers=answers(diagnosis),
        sections=tuple(sections),
        origin=origin(provenance),
    )


def _motion(diagnosis: Diagnosis) -> Section:
    """Speed and torque over time for each recording, and the gaps after each addition."""
    graphs = [_over_time(diagnosis, course) for course in diagnosis.courses]
    loop = Paragraph(
        text=f"The models run in MuJoCo on the recorded torque, held softly to the recorded motion at "
        f"{number(diagnosis.bandwidth, 'rad/s', 3)}."
    )
    return Section(key="motion", heading="Plotted and simulated", blocks=(_steps(diagnosis), *graphs, loop))


def _labels(diagnosis: Diagnosis) -> list[str]:
    first = "inertia and friction"
    return [first if k == 0 else f"+ {words(step.effect)}" for k, step in enumerate(diagnosis.steps)]


def _steps(diagnosis: Diagnosis) -> Table:
    columns = [Heading(heading="model")]
    names = [course.name for course in diagnosis.courses]
    gaps = (effort_word(diagnosis.torque.unit), diagnosis.torque), ("speed", diagnosis.velocity)
    for what, gap in gaps:
        columns += [Heading(heading=f"{what} gap, {name} / {unit_text(gap.unit)}", number=True) for name in names]
    rows = [
        (label, *(number(gap, digits=3) for gap in (*step.torque, *step.velocity)))
        for label, step in zip(_labels(diagnosis), diagnosis.steps, strict=True)
    ]
    rows.append(("noise floor", *(number(gap.noise_floor, digits=3) for _, gap in gaps for _ in names)))
    return Table(caption="RMS gaps before and after each addition", columns=tuple(columns), rows=tuple(rows))


def _over_time(diagnosis: Diagnosis, course: Course) -> TimeGraph:
    shown = [0, *range(max(1, len(diagnosis.steps) - STEPS), len(diagnosis.steps))]
    labels = [_labels(diagnosis)[k] for k in shown]
    first, last = diagnosis.steps[0], diagnosis.steps[-1]
    place = [one.name for one in diagnosis.courses].index(course.name)
    effort = effort_word(diagnosis.torque.unit)
    speed = Plotted(
        "speed", diagnosis.velocity.unit, course.time, course.velocity, [course.velocity_left[k] for k in shown]
    )
    torque = Plotted(
        effort_word(diagnosis.torque.unit),
        diagnosis.torque.unit,
        course.time[course.rows],
        course.torque,
        [course.torque_left[k] for k in shown],
        "modelled",
    )
    alternative = (
        f"Speed and {effort} of {Path(course.origin).name} as measured and as the model has them. RMS of what is left "
        f"with inertia and friction alone, then with all that was found: speed "
        f"{number(first.velocity[place], digits=3)}, "
        f"{number(last.velocity[place], diagnosis.velocity.unit, 3)}; {effort} "
        f"{number(first.torque[place], digits=3)}, "
        f"{number(last.torque[place], diagnosis.torque.unit, 3)}."
    )
    title = {"recording": "The recording.", "holdout": "The holdout, which was not fitted."}[course.name]
    part = course.time.size / sum(one.time.size for one in diagnosis.courses)
    return time_graph(title, alternative, course.time, [speed, torque], labels, part)


def _where(diagnosis: Diagnosis) -> Section:
    """The gap over the coordinates."""
    found = {profile.coordinate: profile for profile in diagnosis.profiles}
    most = diagnosis.profiles[0]
    names = " and ".join(words(effect.name) for effect in diagnosis.effects)
    alternative = (
        f"Mean of measured less modelled {effort_word(diagnosis.torque.unit)} in bins of each coordinate. "
        f"Most of it hangs on {most.coordinate}, {share(most.share)} of its variance."
    )
    graph = Chart(
        title="The gap, and what was found in it.",
        alternative=alternative,
        y_label="gap",
        y_unit=unit_text(diagnosis.torque.unit),
        panels=tuple(_over(found[name], diagnosis, names) for name in DRAWN if name in found),
    )
    columns = (
        Heading(heading="coordinate"),
        Heading(heading="share of the gap", number=True),
        Heading(heading="most of it between", number=True),
        Heading(heading="unit"),
    )
    rows = tuple(
        (
            coordinate_word(one.coordinate, one.unit),
            share(one.share),
            f"{number(one.region[0])} and {number(one.region[1])}",
            unit_text(one.unit),
        )
        for one in diagnosis.where
    )
    table = Table(caption="Share of the gap's variance that each coordinate accounts for", columns=columns, rows=rows)
    return Section(key="where", heading="Where the gap sits", blocks=(graph, table))


def _over(profile: Profile, diagnosis: Diagnosis, names: str) -> Panel:
    x, before, after = (tuple(values.tolist()) for values in _in_order(profile))
    series = [
        noise_band(x, diagnosis.torque.noise_floor),
        Series(name="gap before", style="dots", colour="ink", x=x, y=before),
    ]
    if diagnosis.effects:
        explained = tuple(early - late for early, late in zip(before, after, strict=True))
        series.append(Series(name=f"what {names} makes of it", style="line", colour="model", x=x, y=explained))
        series.append(Series(name="left after", style="rings", colour="left", x=x, y=after))
    note = f"{share(profile.share)} of the gap"
    return Panel(
        x_label=coordinate_word(profile.coordinate, profile.unit),
        x_unit=unit_text(profile.unit),
        note=note,
        series=tuple(series),
    )


def _in_order(profile: Profile) -> tuple[Array, Array, Array]:
    order = np.argsort(profile.centres)
    return profile.centres[order], profile.before[order], profile.after[order]


def _parameters(diagnosis: Diagnosis) -> Section:
    tables = [parameters_table("The axis", diagnosis.parameters)]
    tables += [parameters_table(sentence(words(one.name)), one.parameters) for one in diagnosis.effects]
    if diagnosis.recordings:
        units = {name: found.unit for name, found in diagnosis.parameters.items()}
        tables.append(recordings_table(diagnosis.recordings, diagnosis.between, units))
    return Section(key="parameters", heading="Parameters", blocks=tuple(tables))


def _suspects(diagnosis: Diagnosis) -> Section:
    def of_gap(value: float | None) -> str:
        return "–" if value is None else share(value)

    columns = (
        Heading(heading="effect"),
        Heading(heading="taken"),
        Heading(heading="of the gap, alone", number=True),
        Heading(heading="of what is left, beside the others", number=True),
        Heading(heading="why", prose=True),
    )
    rows = tuple(
        (
            words(one.effect.name),
            "yes" if one.taken else "no",
            of_gap(one.alone),
            of_gap(one.beside),
            one.reason,
        )
        for one in diagnosis.considered
    )
    marked = tuple(k for k, one in enumerate(diagnosis.considered) if one.taken)
    caption = "Every effect of the catalogue: the share it would explain, and why it was taken or was not"
    table = Table(caption=caption, columns=columns, rows=rows, marked=marked)
    return Section(key="suspects", heading="Suspects", blocks=(table,))


def _next(diagnosis: Diagnosis) -> Section:
    """What to record next, and what is unexplained."""
    blocks: list[Paragraph | Points] = [
        Paragraph(text=following(diagnosis) or "Nothing is left open that another motion of this rig would tell.")
    ]
    if diagnosis.because:
        blocks.append(Paragraph(text="What speaks against this being all:"))
        blocks.append(Points(items=tuple(map(words, diagnosis.because))))
    if diagnosis.unexplained_where:
        blocks.append(Points(items=tuple(map(_sits, diagnosis.unexplained_where))))
    return Section(key="next", heading="What to record next", blocks=tuple(blocks))


def _sits(account: Where) -> str:
    """Where a part of what is left is."""
    return (
        f"{share(account.share)} of what is left hangs on {coordinate_word(account.coordinate, account.unit)}, most of "
        f"it between {number(account.region[0])} and {number(account.region[1], account.unit)}"
    )
