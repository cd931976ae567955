"""A diagnosis: what was missing, how sure that is, and whether the simulation moves as the axis does.

As the contract's JSON (`bench.diagnose/1`) and as a document; its pictures show where the gap sits and how it shrinks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import compress
from pathlib import Path
from typing import Any

from bench.axis_kind import ARMATURE, KINDS, AxisKind
from bench.diagnosis.diagnosis import PACKED, Diagnosis, Step, TimeSeries
from bench.diagnosis.name import NamedEffect
from bench.diagnosis.probability import CALIBRATED_ON
from bench.diagnosis.same_axis import SameAxis
from bench.diagnosis.tabulated import UNKNOWN, UnknownEffect
from bench.diagnosis.verdict import Gap
from bench.diagnosis.where import Where
from bench.gate.gate import warnings_of
from bench.names import counted, words
from bench.packed import pack
from bench.plant.model_file import lacking, model_toml, model_xml, tables_toml
from bench.report import document as doc
from bench.report.gap import at_a_glance, gap_chart, remainder, rms_gaps, states, unknown_effect, where_picture
from bench.report.identification import recordings_json
from bench.report.numbers import brief, chance, coordinate_word, effort_word, listed, number, sentence, share, unit_text
from bench.report.over_time import Plotted, time_graph
from bench.report.parts import MOVES, NO_FURTHER, checks_section, origin, parameters_table, recordings_table
from bench.report.publish import write_document
from bench.report.serial import as_json, known, picked, serialised
from bench.report.verdict import reason, reasons

SCHEMA = "bench.diagnose/1"
#: Between rows of the motion to record next - s.
PERIOD = 1e-3
#: Coordinates of the gap that the page draws; its table and the picture have all.
DRAWN = ("position", "velocity", "current", "time")
#: Additions drawn over time at most, the last ones: more would be no page any more.
STEPS = 6
#: Probability with which a set of names contains the truth.
SURE = 0.9
#: Alternatives that are named in a sentence at most, and the least probability of one.
MOST_SHOWN, LEAST_SHOWN = 3, 1e-3


def diagnosis_json(found: Diagnosis, provenance: Mapping[str, Any] | None = None) -> str:
    """The diagnosis as the contract's JSON; `provenance` of the files it came from, null where it came from none."""
    return serialised(diagnosis_content(found, provenance))


def diagnosis_content(found: Diagnosis, provenance: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """The content of that JSON."""
    likely = found.probabilities
    effects = [
        {
            "name": each.name,
            "kind": "measurement" if each.effect.of_measurement else "physics",
            **picked(each, "parameters", "ambiguous_with", "evidence"),
            "probability": likely.of_any((each.name, *each.ambiguous_with)),
            "alternatives": [{"name": one, "probability": p} for one, p in likely.instead_of(each.name).items()],
        }
        for each in found.effects
    ]
    velocity = {  # models held to the recording by a cascade, fed with the recorded effort
        **as_json(found.velocity),
        "loop": {"kind": "held", "bandwidth": {"value": found.velocity.bandwidth, "unit": "rad/s"}},
        **_before_after(found.velocity, "closed_loop", "refined"),
    }
    return {
        "schema": SCHEMA,
        "verdict": found.verdict,
        "because": reasons(found),
        "effects": effects,
        "probability": {
            "none_of_the_catalogue": likely.none,
            "nothing": likely.nothing,
            "set90": [[None] if one is None else sorted(one) for one in likely.holding(SURE)],
            "calibrated_on": CALIBRATED_ON,
        },
        "where": found.where,
        "unexplained": {
            "share": found.unexplained_share,
            "where": found.unexplained_where,
            "tabulated": found.unknown_effect,
        },
        "parameters": found.parameters,
        **recordings_json(found.recordings, found.between, provenance),
        "gap": {"torque": found.torque, "velocity": velocity},
        "steps": [step for step in found.steps[1:] if step.effect != UNKNOWN],
        "rejected": [{"name": name, "reason": reason(why)} for name, why in found.rejected],
        "refused": found.refused,
        "holdout": found.holdout,
        "next_experiment": _experiment_json(found),
        "stopped": found.stopped,
        "provenance": provenance,
        "model": {"mjcf": "model.xml" if found.model is not None else None, "toml": "model.toml"},
        **picked(found, "dead_time", "checks", "warnings"),
    }


@as_json.register
def _(account: Where) -> dict[str, Any]:
    return picked(account, "coordinate", "region", "unit", "share")


@as_json.register
def _(unknown: UnknownEffect) -> dict[str, Any]:
    gap = _before_after(unknown, "torque", "velocity")
    return picked(unknown, "over", "share", "motion") | {"gap": gap, "effects": [one.name for one in unknown.tables]}


def _before_after(result: object, *names: str) -> dict[str, Any]:
    pairs = {name: getattr(result, name) for name in names}
    return {name: pair and {"before": pair[0], "after": pair[1]} for name, pair in pairs.items()}


@as_json.register
def _(gap: Gap) -> dict[str, Any]:
    content = (
        picked(gap, "unit", "noise_floor") | {"limit": known(gap.limit)} | _before_after(gap, "identify", "holdout")
    )
    return content if gap.judged is None else content | {"judged": {"share": gap.judged[0], "after": gap.judged[1]}}


@as_json.register
def _(step: Step) -> dict[str, Any]:
    """Gaps after an addition, of the recording and of the holdout; null where there is none."""
    content: dict[str, Any] = {"effect": step.effect}
    for name, gaps in (("torque_gap", step.torque), ("velocity_gap", step.velocity)):
        content |= {name: known(gaps[0]), f"{name}_holdout": known(gaps[1]) if len(gaps) > 1 else None}
    return content


@as_json.register
def _(compared: SameAxis) -> dict[str, Any]:
    """Whether the holdout is of the same axis; the differing values of the two recordings."""
    differs = [
        {
            "quantity": name,
            "unit": recording.unit,
            "recording": recording.value,
            "holdout": holdout.value,
            "recording_ci95": recording.ci95,
            "holdout_ci95": holdout.ci95,
        }
        for name, (recording, holdout) in compared.differs.items()
    ]
    return {"same_axis": compared.same, "differs": differs}


def _experiment_json(found: Diagnosis) -> dict[str, Any] | None:
    experiment = found.next_experiment
    if experiment is None:
        return None
    speed = found.velocity.unit
    parameters = {
        "top_speed": {"value": experiment.speed, "unit": speed},
        "acceleration": {"value": experiment.acceleration, "unit": f"{speed}**2"},
        "duration": {"value": experiment.duration, "unit": "s"},
        "repetitions": {"value": experiment.repetitions, "unit": "dimensionless"},
    }
    why = picked(experiment, "tells_apart", "separation", "reason")
    return {"profile": experiment.profile, "parameters": parameters, **why}


def write_diagnosis(out: Path, found: Diagnosis, title: str) -> list[Path]:
    """Write the document of a diagnosis and all of it packed into a folder, made if need be; the paths written."""
    return [*write_document(out, diagnosis(found, title)), pack(out / PACKED, found)]


def _caption(one: NamedEffect) -> str:
    """Name of an effect, with the harmonic where an axis may have several, and what it is."""
    waves = [slot.quantity.name for slot in one.effect.shapes if slot.whole and slot.quantity.name in one.parameters]
    numbered = [f"{words(name)} {number(one.parameters[name].value)}" for name in waves]
    return f"{sentence(', '.join([words(one.name), *numbered]))}: {one.effect.summary}"


def diagnosis(
    found: Diagnosis, title: str, provenance: Mapping[str, Any] | None = None, moving: Sequence[doc.Section] = ()
) -> doc.Document:
    """The document of a diagnosis, with `diagnosis.json`, `model.toml` and, where MuJoCo has all of it, `model.xml`.

    `title` names rig and recordings; `moving`: of a robot's joint, the robot in motion.
    """
    tables = [parameters_table("The axis", found.parameters)]
    tables += [parameters_table(_caption(one), one.parameters) for one in found.effects]
    tables += recordings_table(found.recordings, found.between, found.parameters)
    notes, verdict, following = _notes(found), verdict_sentence(found), found.next_experiment
    graphs = [_over_time(found, series) for series in found.time_series]
    glance, units = at_a_glance(found), [(unit, 1.0) for unit in (_kind(found).length_unit, found.velocity.unit)]
    return doc.Document(
        title=title,
        subject=f"Diagnosis of {title}",
        verdict=verdict,
        tone="open" if found.verdict == "unexplained_remainder" else "sure",
        answers=_answers(found),
        glance=glance,
        sections=(
            _motion(found, graphs),
            *moving,
            _where(found, graphs[0]),
            doc.section("parameters", "Parameters", *tables),
            *([doc.section("notes", "Further results", doc.points(notes))] if notes else []),
            _suspects(found),
            _next(found),
            checks_section(found.checks, found.warnings),
            doc.section("model", "The model", doc.downloads(*_files(found, provenance))),
        ),
        origin=origin(provenance),
        pictures=(
            doc.Picture(name="diagnosis", title=verdict, rows=(glance,)),
            where_picture(found, title),
            doc.Picture(name="gaps", title=title, rows=(rms_gaps(found),)),
        ),
        files_in_folder={} if following is None else {"next_experiment.csv": following.motion.csv(PERIOD, *units)},
        warnings=(*found.warnings, *warnings_of(found.checks)),
    )


def _kind(found: Diagnosis) -> AxisKind:
    return next(kind for kind in KINDS if kind.speed_unit == found.velocity.unit)


def _files(found: Diagnosis, provenance: Mapping[str, Any] | None) -> list[doc.File]:
    tables = {"torque_balance": found.balance.table()}
    toml = tables_toml(_kind(found), tables) if found.model is None else model_toml(found.model, tables)
    about = "the model with all that was found, for bench replay"
    files = [doc.file("model.toml", about, toml)]
    if found.model is not None:
        files.append(
            doc.file(
                "model.xml", "the part that MuJoCo has natively; opens without other files", model_xml(found.model)
            )
        )
    return [*files, doc.file("diagnosis.json", "all results as numbers", diagnosis_json(found, provenance) + "\n")]


def verdict_sentence(found: Diagnosis) -> str:
    """What was missing and whether that is all, in a sentence."""
    gap, unit, effort = found.torque, unit_text(found.torque.unit), effort_word(found.torque.unit)
    before, after = gap.identify or (math.nan, math.nan)
    if not found.effects:
        residual = f"the {effort} residual is {number(after, digits=3)} {unit}"
        noise = f"the noise floor {number(gap.noise_floor, digits=3)} {unit}"
        if found.verdict == "nothing_missing":
            return f"No missing effect found: {residual}, {noise}."
        return f"An unknown effect is likely: {reasons(found)[0]} ({residual}, {noise})."
    were, them = ("were", "them") if len(found.effects) > 1 else ("was", "it")
    names = sentence(listed(dict.fromkeys(map(called, found.effects))))
    where = "wrong in the measurement" if len(_sensors(found)) == len(found.effects) else "missing"
    gone = f"{names} {were} {where}; adding {them} removes {share(1.0 - after / before)} of the {effort} gap"
    if found.verdict == "explained":
        times = f", but the simulated speed differs by {number(found.velocity.times_noise, digits=2)} × the noise"
        return f"{gone}, and the {effort} residual is noise{'' if found.velocity.within else times}."
    return f"{gone}, but {words(reasons(found)[0])}."


def called(effect: NamedEffect) -> str:
    """Its name in words, with those of the effects that the recording does not distinguish from it."""
    return " or ".join(map(words, (effect.name, *effect.ambiguous_with)))


def _sensors(found: Diagnosis) -> list[str]:
    return [words(effect.name) for effect in found.effects if effect.effect.of_measurement]


def _answers(found: Diagnosis) -> dict[str, str]:
    of_axis, missing = _kind(found).inertia, []
    for effect in found.effects:  # the zero of a phase is arbitrary
        angles = {quantity.name for quantity in effect.effect.quantities if quantity.angle}
        values = [f"{words(name)} {brief(one)}" for name, one in effect.parameters.items() if name not in angles]
        missing.append(called(effect) + (f" ({', '.join(values)})" if values else ""))
    inertia = ARMATURE if ARMATURE in found.parameters else of_axis
    value = found.parameters.get(inertia)
    lacks = [] if found.model is None else lacking(found.model)
    return {
        "What was missing?": f"{sentence('; '.join(missing)) or 'No effect of the catalogue.'}{_tabulated(found)}",
        "How sure?": _sure(found),
        MOVES: moves(found),
        f"{sentence(words(inertia))}?": f"{brief(value)} (95 %)"
        if value
        else f"Not determined together with the missing effects: {found.refused[of_axis]}",
        "What next?": following(found) or NO_FURTHER,
        **({"Does MuJoCo have all of it?": f"No: {' '.join(lacks)}"} if lacks else {}),
    }


def _tabulated(found: Diagnosis) -> str:
    """That the model contains an unknown effect as a table, and what share of the residual it explains."""
    unknown = found.unknown_effect
    if unknown is None:
        return ""
    before, after = (number(gap, digits=3) for gap in unknown.torque)
    return (
        f"{'.' if found.effects else ''} The model contains an {unknown_effect(found)}: "
        f"it explains {share(unknown.share)} of the squared {effort_word(found.torque.unit)} residual of held-out "
        f"motion ({before} to {after} {unit_text(found.torque.unit)})."
    )


def _sure(found: Diagnosis) -> str:
    """What confirms the verdict, and what contradicts it."""
    gap, lines, effort = found.torque, [likely_names(found)], effort_word(found.torque.unit)
    if found.objections[1:]:
        lines.append(f"In addition: {'; '.join(map(words, reasons(found)[1:]))}.")
    if gap.holdout is not None:
        before, after = gap.holdout
        changes = f"falls from {number(before, digits=3)} to" if after < before else "is"
        lines.append(
            f"On the holdout, which the fit did not use, the {effort} gap {changes} {number(after, gap.unit, 3)}; the "
            f"noise floor is {number(gap.noise_floor, digits=3)}."
        )
    elif found.effects:
        lines.append(
            "Confirmed on a third of the recording that the fit did not use. Give a second recording with --holdout "
            "for a stronger test."
        )
    if found.holdout.same is False:
        lines.append("The holdout is of another axis, or this axis has changed.")
    lines += [
        f"This recording does not distinguish {called(effect).replace(' or ', ' from ', 1)}."
        for effect in found.effects
        if effect.ambiguous_with
    ]
    if len(lines) == 1 and gap.identify is not None:
        chi = number(gap.identify[1] / gap.noise_floor, digits=3)
        lines.append(f"The {effort} residual is {chi} × the noise floor.")
    return " ".join(lines)


def likely_names(found: Diagnosis) -> str:
    """How likely each name is and what it may be instead: `Cogging torque: 99 % (or load torque event: 0.6 %).`"""
    likely, parts = found.probabilities, []
    for effect in {effect.name: effect for effect in found.effects}.values():
        alike = effect.name, *effect.ambiguous_with
        others = {
            other: share for other, share in likely.instead_of(effect.name).items() if other not in (None, *alike)
        }
        instead = f" (or {_chances(others)})" if _chances(others) else ""
        parts.append(f"{_chances({called(effect): likely.of_any(alike)})}{instead}")
    others = {} if found.effects else likely.names | {"no missing effect": likely.nothing}
    none = "an unknown effect in addition" if likely.detected else "an unknown effect"
    parts.append(_chances({**others, none: likely.none}))
    return f"{sentence(', '.join(filter(None, parts)))}."


def _chances(shares: Mapping[str, float]) -> str:
    """The likeliest few of several names, with their probabilities."""
    ranked = sorted(shares.items(), key=lambda one: -one[1])
    return ", ".join(f"{words(name)}: {chance(share)}" for name, share in ranked[:MOST_SHOWN] if share > LEAST_SHOWN)


def moves(found: Diagnosis) -> str:
    """Whether the simulation moves as the axis does: wholly only where nothing speaks against the model."""
    gap = found.velocity
    if gap.final is None:
        return "Not known: MuJoCo cannot simulate the model, or the simulation diverged."
    like = "Nearly" if found.objections else "Yes"
    before = f" ({number(gap.final[0], digits=3)} before)" if found.effects else ""
    where = " on the holdout" if gap.holdout else ""
    return (
        f"{like if gap.within else 'No'}: the simulated speed{where} differs by {number(gap.final[1], gap.unit, 3)} "
        f"RMS{before}; a match is below {number(gap.limit, gap.unit, 2)}."
    )


def following(found: Diagnosis) -> str:
    """What to record or look at next; empty where nothing is open."""
    experiment = found.next_experiment
    if experiment is not None:
        return (
            f"Record {words(experiment.profile)} up to {number(experiment.speed, found.velocity.unit, 3)}, "
            f"{experiment.repetitions} times: it distinguishes {' from '.join(map(words, experiment.tells_apart))} "
            f"({number(experiment.separation, digits=2)} times the noise); {experiment.reason}."
        )
    return " ".join(remainder(found))


def _motion(found: Diagnosis, graphs: Sequence[doc.TimeGraph]) -> doc.Section:
    """Speed and torque over time for each recording, and the gaps after each addition."""
    names = [series.name for series in found.time_series]
    both = (effort_word(found.torque.unit), found.torque), ("speed", found.velocity)
    headings = [f"{what} gap, {name} / {unit_text(gap.unit)}>" for what, gap in both for name in names]
    rows = [
        (label, *(number(gap, digits=3) for gap in (*step.torque, *step.velocity)))
        for label, step in zip(states(found), found.steps, strict=True)
    ]
    rows.append(("noise floor", *(number(gap.noise_floor, digits=3) for _, gap in both for _ in names)))
    steps = doc.table("RMS gaps before and after each addition", ("model", *headings), rows)
    loop = "The models run in MuJoCo on the recorded torque, weakly coupled to the recorded motion at "
    held = doc.Paragraph(text=f"{loop}{number(found.velocity.bandwidth, 'rad/s', 3)}.")
    return doc.section("motion", "Measured and simulated", steps, *rms_gaps(found), *graphs, held)


def _over_time(found: Diagnosis, series: TimeSeries) -> doc.TimeGraph:
    shown = [0, *range(max(1, len(found.steps) - STEPS), len(found.steps))]
    labels, effort = states(found), effort_word(found.torque.unit)
    first, last = found.steps[0], found.steps[-1]
    place = [one.name for one in found.time_series].index(series.name)
    speeds, torques = ([rest[k] for k in shown] for rest in (series.velocity_residuals, series.torque_residuals))
    signals = [
        Plotted("speed", found.velocity.unit, series.time, series.velocity, speeds),
        Plotted(effort, found.torque.unit, series.time[series.rows], series.torque, torques, "modelled"),
    ]
    alternative = (
        f"Speed and {effort} of {Path(series.origin).name}, measured and modelled. RMS residuals "
        f"with inertia and friction only, then with all effects found: speed "
        f"{number(first.velocity[place], digits=3)}, {number(last.velocity[place], found.velocity.unit, 3)}; {effort} "
        f"{number(first.torque[place], digits=3)}, {number(last.torque[place], found.torque.unit, 3)}. "
        f"{sentence(effort)} has holes about standstill, where the direction of friction is not known."
    )
    title = {"recording": "The recording.", "holdout": "The holdout, which was not fitted."}[series.name]
    return time_graph(title, alternative, series.time, signals, [labels[k] for k in shown])


def _where(found: Diagnosis, over: doc.TimeGraph) -> doc.Section:
    rows = []
    for one in found.where:
        between = " and ".join(map(number, one.region))
        rows.append((coordinate_word(one.coordinate, one.unit), share(one.share), between, unit_text(one.unit)))
    headings = ("coordinate", "share of the gap>", "most of it between>", "unit")
    shares = doc.table("Share of the gap's variance that each coordinate accounts for", headings, rows)
    blocks = (gap_chart(found, DRAWN, over), shares)
    return doc.section("where", "Where the gap is", *blocks, detail=True)


def _notes(found: Diagnosis) -> list[str]:
    """What was found in addition to effects and parameters."""
    unit, sensors = found.velocity.unit, _sensors(found)
    lines = [f"at fault is the sensor, not the axis: {', '.join(sensors)}"] if sensors else []
    lines += [
        f"the holdout differs: {words(name)} {number(recording.value)} to {number(holdout.value, recording.unit)}"
        for name, (recording, holdout) in found.holdout.differs.items()
    ]
    pairs = {
        "under the rig's drive": found.velocity.closed_loop,
        "of held-out motion, refined by simulation": found.velocity.refined,
    }
    lines += [
        f"velocity gap {name}: {number(pair[0])} to {number(pair[1], unit)}" for name, pair in pairs.items() if pair
    ]
    lines += [f"rejected: {words(name)}, {reason(why)}" for name, why in found.rejected]
    lines += [f"refused: {words(name)}, {reason}" for name, reason in found.refused.items()]
    lines += [f"stopped: {found.stopped}"] if found.stopped else []
    lines += [f"unexplained: {share(found.unexplained_share)} of the gap"] if found.unexplained_where else []
    return lines


def _suspects(found: Diagnosis) -> doc.Section:
    rows = [
        (
            words(one.effect.name),
            "yes" if one.accepted else "no",
            chance(one.probability),
            *(None if value is None else share(value) for value in (one.of_gap, one.of_residual)),
            reason(one.reason),
        )
        for one in found.considered
    ]
    caption = (
        "Effects of the catalogue: the share of the squared gap that each explains as the only effect, the share of "
        "the squared residual that it explains in addition to those found, and why it was or was not added"
    )
    headings = ("effect", "added", "probability>", "of the gap>", "of the residual>", "reason~")
    shown = [one.accepted or one.probability > LEAST_SHOWN for one in found.considered]
    likely, rest = (list(compress(rows, kept)) for kept in (shown, [not kept for kept in shown]))
    accepted = [one.effect.name if one.accepted else "" for one in compress(found.considered, shown)]
    place = {name: f"#parameters-{k}" for k, name in enumerate(found.names, 2)}  # after the table of the axis
    tables = [doc.table(caption, headings, likely, (k for k, name in enumerate(accepted) if name))] if likely else []
    if likely:
        tables[0] = tables[0].model_copy(update={"links": tuple(place.get(name, "") for name in accepted)})
    if rest:
        limit = f"{counted(len(rest), 'effect')} with a probability of at most {share(LEAST_SHOWN)}"
        tables.append(doc.table(limit, headings, rest).model_copy(update={"folded": True}))
    return doc.section("suspects", "Suspects", *tables, detail=True)


def _next(found: Diagnosis) -> doc.Section:
    """What to record next, and what is unexplained."""
    text = following(found) or NO_FURTHER
    blocks: list[doc.Paragraph | doc.Points] = [doc.Paragraph(text=text)]
    if found.objections:
        blocks += [doc.Paragraph(text="Evidence of a further effect:"), doc.points(map(words, reasons(found)))]
    return doc.section("next", "What to record next", *blocks, detail=True)
