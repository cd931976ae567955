"""The page of a diagnosis: what was missing, how sure that is, and whether the simulation moves as the axis does."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bench.axis_kind import INERTIA, KINDS
from bench.diagnose.add.refine import NULL
from bench.diagnose.diagnosis import Diagnosis
from bench.diagnose.found import Course, Gap, NamedEffect, Profile
from bench.report.page.blocks import (
    Answer,
    Column,
    Downloads,
    File,
    GapGraph,
    Over,
    Page,
    Paragraph,
    Points,
    Section,
    Table,
    TimeGraph,
)
from bench.report.page.numbers import interval, number, sentence, share, unit_text, words
from bench.report.pages.over_time import Measured, time_graph
from bench.report.pages.tables import checks_section, origin, parameters_table, recordings_table

#: Coordinates of the gap that are drawn; the table has all.
DRAWN = ("position", "velocity", "current", "time")
#: Additions drawn over time at most, the last ones: more would be no page any more.
STEPS = 6


def diagnosis_page(
    diagnosis: Diagnosis, title: str, files: Sequence[File], provenance: Mapping[str, Any] | None = None
) -> Page:
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
    return Page(
        title=title,
        subject=f"Diagnosis of {title}",
        verdict=verdict_sentence(diagnosis),
        tone="sure" if explained else "open",
        answers=_answers(diagnosis),
        sections=tuple(sections),
        origin=origin(provenance),
    )


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """What was missing and how much of the gap it accounts for, in a sentence."""
    gap, unit = diagnosis.torque, unit_text(diagnosis.torque.unit)
    before, after = gap.identify or (math.nan, math.nan)
    noise = f"the noise floor is {number(gap.noise_floor, digits=3)} {unit}"
    if not diagnosis.effects:
        if diagnosis.verdict == "nothing_missing":
            left = f"inertia and friction leave {number(after, digits=3)} {unit} of the torque"
            return f"Nothing is missing: {left}, {noise}."
        return (
            f"Something is missing that no effect of the catalogue explains: {number(after, digits=3)} {unit} "
            f"of the torque are left, {noise}."
        )
    several = len(diagnosis.effects) > 1
    named = "; ".join(_named(effect) for effect in diagnosis.effects)
    sensors = all(effect.effect.kind == "measurement" for effect in diagnosis.effects)
    what = f"{'were' if several else 'was'} {'wrong in the measurement' if sensors else 'missing'}"
    gone = f"with {'them' if several else 'it'} {share(1.0 - after / before)} of the torque gap is gone"
    if diagnosis.verdict == "explained":
        return f"{sentence(named)} {what}; {gone}, and what is left is noise."
    return f"{sentence(named)} {what}; {gone}, but {number(_chi(gap), digits=2)} times the noise is left."


def _named(effect: NamedEffect) -> str:
    """An effect with its quantities; a phase says nothing to a reader."""
    angles = {quantity.name for quantity in effect.effect.quantities if quantity.angle}
    told = [f"{words(name)} {interval(found)}" for name, found in effect.parameters.items() if name not in angles]
    return f"{words(effect.name)} ({', '.join(told)})" if told else words(effect.name)


def _answers(diagnosis: Diagnosis) -> tuple[Answer, ...]:
    kind = next(kind for kind in KINDS if kind.speed_unit == diagnosis.velocity.unit)
    inertia = diagnosis.parameters[kind.parameter(INERTIA)]
    names = "; ".join(f"{_named(effect)}: {effect.effect.summary}" for effect in diagnosis.effects)
    told = {
        f"{sentence(kind.spoken(INERTIA))}?": f"{interval(inertia)} (95 %)",
        "What was missing?": names or "No effect of the catalogue.",
        "How sure?": _sure(diagnosis),
        "Does it move like the axis now?": _moves(diagnosis.velocity, bool(diagnosis.effects)),
        "What next?": _following(diagnosis) or "Nothing is left open that another motion would tell.",
    }
    return tuple(Answer(question=question, answer=answer) for question, answer in told.items())


def _sure(diagnosis: Diagnosis) -> str:
    """What bears the verdict out, and what speaks against it."""
    gap, said = diagnosis.torque, []
    if diagnosis.because:
        said.append(f"Not wholly: {'; '.join(diagnosis.because)}.")
    if gap.holdout is not None:
        before, after = gap.holdout
        said.append(
            f"On the recording that was not fitted the torque gap goes from {number(before, digits=3)} to "
            f"{number(after, gap.unit, 3)}, where noise alone leaves {number(gap.noise_floor, digits=3)}."
        )
    elif diagnosis.effects:
        said.append("The last third of the recording, kept from the fit, bears it out; no holdout was given.")
    if diagnosis.holdout.same is False:
        said.append("The holdout is of another axis, or of this one changed.")
    said += [
        f"{sentence(words(effect.name))} cannot be told here from {' or '.join(map(words, effect.ambiguous_with))}."
        for effect in diagnosis.effects
        if effect.ambiguous_with
    ]
    if not said:
        said.append(f"What is left of the torque is {number(_chi(gap), digits=3)} times what noise alone leaves.")
    return " ".join(said)


def _chi(gap: Gap) -> float:
    return math.nan if gap.identify is None else gap.identify[1] / gap.noise_floor


def _moves(gap: Gap, added: bool) -> str:
    """Whether the simulation moves as the axis does."""
    pair = gap.holdout or gap.identify
    if pair is None:
        return "Not known: MuJoCo cannot have the model, or it diverged."
    like = "Yes" if pair[1] <= NULL * gap.noise_floor else "Not wholly"
    before = f", {number(pair[0], digits=3)} before" if added else ""
    where = "on the recording that was not fitted" if gap.holdout else "on the recording"
    return (
        f"{like}: simulated speed is off by {number(pair[1], gap.unit, 3)} RMS {where}{before}; "
        f"the sensor's noise is {number(gap.noise_floor, digits=3)}."
    )


def _motion(diagnosis: Diagnosis) -> Section:
    """Speed and torque over time for each recording, and the gaps after each addition."""
    graphs = [_over_time(diagnosis, course) for course in diagnosis.courses]
    loop = Paragraph(
        text=f"The models run in MuJoCo on the recorded torque, held softly to the recorded motion at "
        f"{number(diagnosis.bandwidth, 'rad/s', 3)}."
    )
    return Section(key="motion", heading="Measured and simulated", blocks=(_steps(diagnosis), *graphs, loop))


def _labels(diagnosis: Diagnosis) -> list[str]:
    first = "inertia and friction"
    return [first if k == 0 else f"+ {words(step.effect)}" for k, step in enumerate(diagnosis.steps)]


def _steps(diagnosis: Diagnosis) -> Table:
    columns = [Column(heading="model")]
    names = [course.name for course in diagnosis.courses]
    gaps = ("torque", diagnosis.torque), ("velocity", diagnosis.velocity)
    for what, gap in gaps:
        columns += [Column(heading=f"{what} gap, {name} / {unit_text(gap.unit)}", number=True) for name in names]
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
    speed = Measured(
        "speed", diagnosis.velocity.unit, course.time, course.velocity, [course.velocity_left[k] for k in shown]
    )
    torque = Measured(
        _effort(diagnosis.torque.unit),
        diagnosis.torque.unit,
        course.time[course.rows],
        course.torque,
        [course.torque_left[k] for k in shown],
        "modelled",
    )
    told = (
        f"Speed and torque of {Path(course.origin).name} as measured and as the model has them. RMS of what is left "
        f"with inertia and friction alone, then with all that was found: speed "
        f"{number(first.velocity[place], digits=3)}, "
        f"{number(last.velocity[place], diagnosis.velocity.unit, 3)}; torque {number(first.torque[place], digits=3)}, "
        f"{number(last.torque[place], diagnosis.torque.unit, 3)}."
    )
    title = {"recording": "The recording.", "holdout": "The holdout, which was not fitted."}[course.name]
    part = course.time.size / sum(one.time.size for one in diagnosis.courses)
    return time_graph(title, told, course.time, [speed, torque], labels, part)


def _effort(unit: str) -> str:
    return {"N*m": "torque", "N": "force", "A": "current", "V": "voltage"}.get(unit, "effort")


def _where(diagnosis: Diagnosis) -> Section:
    """The gap over the coordinates."""
    found = {profile.coordinate: profile for profile in diagnosis.profiles}
    most = diagnosis.profiles[0]
    names = " and ".join(words(effect.name) for effect in diagnosis.effects)
    told = (
        f"Mean of measured less modelled {_effort(diagnosis.torque.unit)} in bins of each coordinate. "
        f"Most of it hangs on {most.coordinate}, {share(most.share)} of its variance."
    )
    graph = GapGraph(
        title="The gap, and what was found in it.",
        alternative=told,
        label="gap",
        unit=unit_text(diagnosis.torque.unit),
        floor=diagnosis.torque.noise_floor,
        explained=f"what {names} makes of it" if names else "",
        panels=tuple(_over(found[name], diagnosis) for name in DRAWN if name in found),
    )
    columns = (
        Column(heading="coordinate"),
        Column(heading="share of the gap", number=True),
        Column(heading="most of it between", number=True),
        Column(heading="unit"),
    )
    rows = tuple(
        (one.coordinate, share(one.share), f"{number(one.region[0])} and {number(one.region[1])}", unit_text(one.unit))
        for one in diagnosis.where
    )
    table = Table(caption="Share of the gap's variance that each coordinate accounts for", columns=columns, rows=rows)
    return Section(key="where", heading="Where the gap sits", blocks=(graph, table))


def _over(profile: Profile, diagnosis: Diagnosis) -> Over:
    after = tuple(profile.after.tolist()) if diagnosis.effects else None
    return Over(
        label=_coordinate(profile),
        unit=unit_text(profile.unit),
        note=f"{share(profile.share)} of the gap",
        x=tuple(profile.centres.tolist()),
        before=tuple(profile.before.tolist()),
        after=after,
    )


def _coordinate(profile: Profile) -> str:
    """What a coordinate is called where its unit says that it is another signal: torque was recorded, no current."""
    return _effort(profile.unit) if profile.coordinate == "current" else profile.coordinate


def _parameters(diagnosis: Diagnosis) -> Section:
    tables = [parameters_table("The axis", diagnosis.parameters)]
    tables += [parameters_table(sentence(words(one.name)), one.parameters) for one in diagnosis.effects]
    if diagnosis.recordings:
        units = {name: found.unit for name, found in diagnosis.parameters.items()}
        tables.append(recordings_table(diagnosis.recordings, diagnosis.between, units))
    return Section(key="parameters", heading="Parameters", blocks=tuple(tables))


def _suspects(diagnosis: Diagnosis) -> Section:
    def told(value: float | None) -> str:
        return "–" if value is None else share(value)

    columns = (
        Column(heading="effect"),
        Column(heading="taken"),
        Column(heading="of the gap, alone", number=True),
        Column(heading="of what is left, beside the others", number=True),
        Column(heading="why", prose=True),
    )
    rows = tuple(
        (words(one.effect.name), "yes" if one.taken else "no", told(one.alone), told(one.beside), one.reason)
        for one in diagnosis.considered
    )
    marked = tuple(k for k, one in enumerate(diagnosis.considered) if one.taken)
    caption = "Every effect of the catalogue: the share it would explain, and why it was taken or was not"
    table = Table(caption=caption, columns=columns, rows=rows, marked=marked)
    return Section(key="suspects", heading="Suspects", blocks=(table,))


def _following(diagnosis: Diagnosis) -> str:
    found = diagnosis.next_experiment
    if found is None:
        return ""
    times = number(found.separation, digits=2)
    return (
        f"Record {words(found.profile)} up to {number(found.speed, diagnosis.velocity.unit, 3)}, "
        f"{found.repetitions} times: it tells {' from '.join(map(words, found.tells_apart))} "
        f"({times} times the noise); {found.reason}."
    )


def _next(diagnosis: Diagnosis) -> Section:
    """What to record next, and what is unexplained."""
    blocks: list[Paragraph | Points] = [
        Paragraph(text=_following(diagnosis) or "Nothing is left open that another motion of this rig would tell.")
    ]
    if diagnosis.because:
        blocks.append(Paragraph(text="What speaks against this being all:"))
        blocks.append(Points(items=tuple(diagnosis.because)))
    if diagnosis.unexplained_where:
        blocks.append(
            Points(
                items=tuple(
                    f"{share(one.share)} of what is left hangs on {one.coordinate}, most of it between "
                    f"{number(one.region[0])} and {number(one.region[1], one.unit)}"
                    for one in diagnosis.unexplained_where
                )
            )
        )
    return Section(key="next", heading="What to record next", blocks=tuple(blocks))
