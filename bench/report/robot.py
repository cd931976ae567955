"""A robot by its logs: a row for each joint, and below each diagnosis.

As the contract's JSON (`bench.robot/1`) and as a document, which has the MJCF with all joints to take along.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bench.axis_kind import ARMATURE, COULOMB, VISCOUS
from bench.joints.goals import COMMAND
from bench.joints.grade import GradedJoint
from bench.joints.identified import EFFECTS, IdentifiedJoint
from bench.joints.robot import IdentifiedRobot
from bench.names import readable, words
from bench.parameter import Parameter
from bench.plant.model_file import joints_toml
from bench.report import document as doc
from bench.report.diagnosis import diagnosis, diagnosis_content, following, likely_names, moves
from bench.report.grade import grade_json, grade_section
from bench.report.numbers import interval, number, sentence, unit_text
from bench.report.parts import MOVES, NO_FURTHER, origin, parameters_table
from bench.report.serial import as_json, picked, serialised
from bench.report.servo import of_trainers, servo, servo_answers, servo_content
from bench.report.simulation import moving_section
from bench.report.verdict import reasons

SCHEMA = "bench.robot/1"
MJCF, EFFECTS_FILE, JSON = "robot_id.xml", "effects.toml", "robot.json"
#: Columns of the table of joints, and those of them that only joints with goals have.
COLUMNS = ("armature", "viscous", "Coulomb", "static", "dead time", "bias", "kp", "kv")
EXTRA = COLUMNS[3:]
#: Joints that an answer lists.
SUMMARISED = 3
#: Sections of a diagnosis that a robot's page has of each joint.
SHOWN = ("motion", "where", "parameters", "separate", "notes", "checks")


def robot_json(
    found: IdentifiedRobot, provenance: Mapping[str, Any] | None = None, grade: Mapping[str, GradedJoint] | None = None
) -> str:
    """The robot as the contract's JSON, with its grade where that is asked for."""
    payload = found.payload and {
        **picked(found.payload, "body", "mass"),
        "center_of_mass": {
            "value": [x.value for x in found.payload.centre],
            "unit": "m",
            "ci95": [as_json(x)["ci95"] for x in found.payload.centre],
        },
    }
    content = {
        "schema": SCHEMA,
        "joints": {name: _joint_json(joint) for name, joint in found.joints.items()},
        "payload": payload,
        "links": [
            {"joint": joint, "inertia_factor": one.value, "ci95": one.ci95} for joint, one in found.links.items()
        ],
        "zeros": [{"joint": joint, **as_json(zero)} for joint, zero in found.zeros.items()],
        "model": {"mjcf": MJCF, "effects": EFFECTS_FILE},
        "warnings": found.warnings,
        "provenance": provenance,
    }
    return serialised(content if grade is None else content | {"grade": grade_json(grade)})


def _joint_json(joint: IdentifiedJoint) -> dict[str, Any]:
    """As `diagnose` has it, but for what belongs to the whole robot; without a diagnosis what is known all the same."""
    content: dict[str, Any] = {"verdict": None, "effects": []}
    if joint.diagnosis is not None:
        content = diagnosis_content(joint.diagnosis)
        for name in ("schema", "provenance", "model"):
            del content[name]
    elif joint.servo is not None:
        content = servo_content(joint.servo)
    elif joint.estimate is not None:
        content["explained"] = joint.estimate.explained
    if joint.friction_models:
        content["friction_models"] = [
            {**picked(one, "error", "chosen", "parameters"), "model": one.name.lower()} for one in joint.friction_models
        ]
    content |= picked(joint, "parameters", "refused", "checks", "warnings")
    return {**content, "record": joint.record or None, "failed": joint.failed or None, "left_out": joint.left_out}


def robot(
    found: IdentifiedRobot,
    title: str,
    provenance: Mapping[str, Any] | None = None,
    out: Path | None = None,
    grade: Mapping[str, GradedJoint] | None = None,
) -> doc.Document:
    """The document of a robot that `title` names; of one that goes into a folder, with its MJCF, models and JSON.

    `grade`: of its MJCF, where that is asked for.
    """
    motions = {name: joint.motion for name, joint in found.joints.items() if joint.motion is not None}
    sections = [doc.section("joints", "Joints", *_tables(found))]
    sections += [] if grade is None else [grade_section(grade, readable(found.mjcf.name))]
    sections += [moving_section(found.mjcf, motions)] if motions else []
    sections += [_of_joint(k, joint, found) for k, joint in enumerate(found.joints.values(), 1)]
    if out is not None:
        text, took = found.with_joints(out / MJCF)
        files = doc.downloads(
            doc.file(MJCF, "the MJCF with the joints as found", text),
            doc.file(EFFECTS_FILE, "models of all joints, for bench.Effects", joints_toml(found.models)),
            *(of_trainers(servos) if (servos := found.actuators) else []),
            doc.file(JSON, "all results as numbers", robot_json(found, provenance, grade) + "\n"),
        )
        sections.append(doc.section("model", "The model", doc.points(took), files, detail=True))
    return doc.Document(
        title=title,
        subject=f"Joints of {title}",
        verdict=_verdict(found),
        tone="refused" if not found.answered else "sure" if _settled(found) == len(found.joints) else "open",
        answers=_answers(found),
        sections=tuple(sections),
        origin=origin(provenance),
        warnings=(*found.warnings, *_joint_warnings(found)),
    )


def _joint_warnings(found: IdentifiedRobot) -> list[str]:
    """Warnings of the joints, each once with the names of those that it concerns."""
    concerned = _concerned({name: joint.warnings for name, joint in found.joints.items()})
    return [f"{names}: {warning}" for names, warning in concerned]


def _concerned(texts: Mapping[str, Sequence[str]]) -> list[tuple[str, str]]:
    """Names of the joints that each of their texts concerns, and the text."""
    names: dict[str, list[str]] = {}
    for name, every in texts.items():
        for text in every:
            names.setdefault(text, []).append(name)
    return [("all joints" if len(some) == len(texts) > 1 else ", ".join(some), text) for text, some in names.items()]


def _answers(found: IdentifiedRobot) -> dict[str, str]:
    """What was missing, how sure and how large, whether the joints move like the robot, and what to record next."""
    known = {name: joint.diagnosis for name, joint in found.joints.items() if joint.diagnosis is not None}
    fitted = {name: servo_answers(joint.servo) for name, joint in found.joints.items() if joint.servo is not None}
    named = {name: one for name, one in known.items() if one.effects}
    texts: dict[str, dict[str, str]] = {
        "What was missing?": {
            name: f"{', '.join(words(effect.effect.name) for effect in one.effects)}." for name, one in named.items()
        },
        "How sure?": {name: likely_names(one) for name, one in (named or known).items()},
        "RMS torque gap, before and after?": {
            name: f"{number(one.torque.identify[0], digits=3)} to {number(one.torque.identify[1], one.torque.unit, 3)}."
            for name, one in (named or known).items()
            if one.torque.identify is not None
        },
        MOVES: {name: moves(one) for name, one in (named or known).items()},
        "What next?": {name: text for name, joint in found.joints.items() for _, text in _open(joint) if text},
    }
    for name, own in fitted.items():
        for question, text in own.items():
            texts.setdefault(question, {})[name] = text
    none = {"What was missing?": "No missing effect found.", "What next?": NO_FURTHER} if known or fitted else {}
    answers = {question: _by_joint(of) or none.get(question, "") for question, of in texts.items()}
    return {question: text for question, text in answers.items() if text}


def _by_joint(texts: Mapping[str, str]) -> str:
    """Texts of the first joints, and how many more there are."""
    shown = [f"{name}: {text}" for name, text in [*texts.items()][:SUMMARISED]]
    more = len(texts) - len(shown)
    return " ".join([*shown, *([f"{more} more joints are listed below."] if more > 0 else [])])


def _settled(found: IdentifiedRobot) -> int:
    """How many joints leave nothing open."""
    return sum(joint.verdict not in (None, "unexplained_remainder") for joint in found.joints.values())


def _verdict(found: IdentifiedRobot) -> str:
    whole, answered, settled = len(found.joints), len(found.answered), _settled(found)
    if not answered:
        return f"None of {whole} joints could be answered."
    if not found.models:
        return f"No model of {whole} joints: neither armature nor friction is determined."
    some = (
        "no residual is"
        if settled == 0
        else "the residual of one is"
        if settled == 1
        else f"the residuals of {settled} are"
    )
    rest = "all residuals are noise" if settled == answered else f"{some} noise"
    return f"{answered} of {whole} joints are identified; {rest}."


def _tables(found: IdentifiedRobot) -> list[doc.Table]:
    """A row for each joint; and what is open, where anything is."""
    headings, cells = [], []
    values = [_values(joint) for joint in found.joints.values()]
    for name, column in zip(COLUMNS, zip(*values, strict=True), strict=True):
        if name in EXTRA and not any(column):
            continue
        units = {value.unit for value in column if value is not None}
        alike = len(units) == 1  # then it is in the heading
        headings.append(f"{name} / {unit_text(units.pop())}>" if alike else f"{name}>")
        cells.append([None if value is None else interval(value, unit=not alike) for value in column])
    missing = map(_missing, found.joints.values())
    headings = ("joint", *headings, "what was missing, and how sure~")
    caption = "Values ± half of their intervals of 95 %, in SI, on the motor's side but the armature"
    tables = [doc.table(caption, headings, zip(found.joints, *cells, missing, strict=True))]
    compared = {name: joint.friction_models for name, joint in found.joints.items() if joint.friction_models}
    if compared:
        heads = ("joint", *(f"{model.name}>" for model in next(iter(compared.values()))), "model~")
        rows = [
            (name, *(number(one.error, digits=3) for one in models), next(one.name for one in models if one.chosen))
            for name, models in compared.items()
        ]
        caption = (
            "RMS error of torque that was not fitted / N·m (N), by friction model; the simplest as good as the best"
        )
        tables.append(doc.table(caption, heads, rows))
    constants = [(name, interval(joint.constant)) for name, joint in found.joints.items() if joint.constant is not None]
    if constants:
        caption = "Torque constants by the weight of the links; negative where the log counts the current the other way"
        tables.append(doc.table(caption, ("joint", "torque constant>"), constants))
    if found.payload is not None:
        centre = ", ".join(interval(x) if math.isfinite(x.half_width) else "unknown" for x in found.payload.centre)
        row = (found.payload.body, interval(found.payload.mass), centre)
        tables.append(doc.table("Payload", ("body", "mass>", "centre in the body's frame>"), [row]))
    if found.links:
        rows = ((joint, f"{interval(factor)} times the MJCF's") for joint, factor in found.links.items())
        caption = "Links whose inertia about their joint's axis is not the MJCF's"
        tables.append(doc.table(caption, ("joint", "inertia~"), rows))
    if found.zeros:
        rows = ((joint, interval(zero)) for joint, zero in found.zeros.items())
        tables.append(doc.table("Zeros that are not the MJCF's", ("joint", "MJCF's position less the log's>"), rows))
    lacking = [(name, why, motion) for name, joint in found.joints.items() for why, motion in _open(joint)]
    if lacking:
        tables.append(doc.table("Not determined by the logs", ("joint", "what~", "record instead~"), lacking))
    advice = {name: one.servo.found.advice if one.servo is not None else () for name, one in found.joints.items()}
    if any(advice.values()):
        rows = _concerned(advice)
        tables.append(doc.table("What would separate parameters of servos", ("joint", "record~"), rows))
    return tables


def _values(joint: IdentifiedJoint) -> tuple[Parameter | None, ...]:
    """Parameters of COLUMNS; None for one that is not determined."""
    if joint.rig is None:
        return (None,) * len(COLUMNS)
    kind = joint.rig.axis_kind
    friction = kind.parameter(VISCOUS), kind.parameter(COULOMB), f"static_friction_{kind.effort}"
    names = (ARMATURE, *friction, *COMMAND, "kp", "kv")
    return tuple(joint.parameters.get(name) for name in names)


def _missing(joint: IdentifiedJoint) -> str:
    """What was missing, and how sure that is."""
    if joint.servo is not None:
        after, names = joint.servo.gaps["identify"].after, ", ".join(map(words, joint.servo.found.effects))
        rest = "unknown effect" if joint.verdict == "unexplained_remainder" else "" if names else "nothing"
        found = "; ".join(filter(None, (names, rest)))
        off = number(after, joint.servo.kind.length_unit, 3), number(after / joint.servo.noise_floor, digits=2)
        return f"{found}; free-running position off by {off[0]} RMS, {off[1]} × the noise"
    if joint.diagnosis is None:
        return "not determined"
    left = f" {'; '.join(map(words, reasons(joint.diagnosis)))}" if joint.diagnosis.objections else ""
    return f"{'' if joint.diagnosis.effects else 'None named. '}{likely_names(joint.diagnosis)}{sentence(left)}"


def _open(joint: IdentifiedJoint) -> list[tuple[str, str]]:
    """What is not determined of a joint, and what to record instead."""
    if joint.failed:
        return [(joint.failed, "")]
    called = {EFFECTS: "whether anything is missing"}
    reasons: dict[str, list[str]] = {}
    for name, reason in joint.refused.items():
        reasons.setdefault(reason, []).append(called.get(name, words(name)))
    found = [(f"{', '.join(names)}: {reason}", joint.record) for reason, names in reasons.items()]
    more = "" if joint.diagnosis is None else following(joint.diagnosis)
    return found + ([("more", more)] if more else [])


def _of_joint(k: int, joint: IdentifiedJoint, found: IdentifiedRobot) -> doc.Section:
    key, heading = f"joint-{k}", joint.name
    if joint.servo is not None:
        own = servo(joint.servo, f"{joint.name} of {readable(found.mjcf.name)}")
        return _shortened(key, heading, own)
    if joint.diagnosis is None:
        tables = [parameters_table("Inertia and friction", joint.parameters)] if joint.parameters else []
        why = doc.points(what for what, _ in _open(joint))
        return doc.section(key, heading, why, *tables, detail=True)
    own = diagnosis(joint.diagnosis, f"{joint.name} of {readable(found.mjcf.name)}")
    return _shortened(key, heading, own)


def _shortened(key: str, heading: str, own: doc.Document) -> doc.Section:
    """A joint's own document as a section of its robot's."""
    blocks = [block for section in own.sections if section.key in SHOWN for block in section.blocks]
    answers = doc.points(f"{question} {answer}" for question, answer in own.answers.items())
    return doc.section(key, heading, doc.Paragraph(text=own.verdict), answers, *blocks, detail=True)
